#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "evaluate/predictor.h"
#include "generate/progress.h"

namespace toile::evaluate {

struct PredictOptions {
    std::string dataset, out;  ///< files
    PredictorOptions predictor;
    generate::ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between batches
};

/// How far the predictions of a split are from the cloth.
struct SplitError {
    std::int64_t samples = 0;
    double sqrt_mse = 0;  ///< square root of the mean over samples and vertices of |r̂ − r_T|² [m]
    double max_dist = 0;  ///< mean over samples of the largest |r̂ − r_T| [m]
};

struct PredictSummary {
    std::string predictor;
    int vertices = 0;
    std::vector<FitFact> facts;
    std::array<SplitError, 3> error;      ///< by split; those without accepted samples have none
    double fit_seconds = 0, seconds = 0;  ///< wall time of the fit, of all [s]
};

/// Fits a predictor on the accepted samples of the train split and writes a predictions file (files/predictions_file.h)
/// of all accepted samples, whole or not at all. Neither the file nor the errors depend on `jobs`; what is not in the
/// train split changes no prediction but its own. Throws Error for what is wrong with the options or the data set, and
/// `generate::Interrupted`.
PredictSummary predict(const PredictOptions& options);

/// What came of it, in lines.
std::string predict_table(const PredictSummary& summary);

}  // namespace toile::evaluate

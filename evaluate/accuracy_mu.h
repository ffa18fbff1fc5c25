#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "evaluate/mu_fit.h"
#include "evaluate/prediction_source.h"
#include "files/dataset_file.h"
#include "generate/progress.h"

namespace toile::evaluate {

enum class LearnMu { none, global, vertex };

/// What was learned for one predictor.
struct LearnedMu {
    std::string predictor;
    MuFit fit;
};

struct LearnMuOptions {
    LearnMu what = LearnMu::vertex;
    int jobs = 1;
    generate::ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;
};

/// Learns μ of the quasistatic prior for a predictor, on the accepted train samples of the data set with those of the
/// validation split to choose by (evaluate/mu_fit.h), drawn by the data set's seed. Throws Error where there are no
/// train samples.
LearnedMu learn_mu(const files::DatasetReader& dataset, const PredictionSource& source, const LearnMuOptions& options);

}  // namespace toile::evaluate

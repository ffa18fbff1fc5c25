#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/accuracy_figures.h"
#include "evaluate/accuracy_mu.h"
#include "evaluate/judged_samples.h"
#include "generate/progress.h"

namespace toile::evaluate {

struct AccuracyOptions {
    std::string dataset;
    std::vector<std::string> predictions;  ///< files; without any, the built-in predictors are fitted and judged
    std::string noise;                     ///< noise.h5; empty: that in `folder`, if there is one
    std::string folder;       ///< made if it is not there; accuracy.json and accuracy.h5 in it are replaced
    std::vector<int> splits;  ///< 0 train, 1 validation, 2 test; empty: all that have accepted samples
    std::vector<double> limits{0.0, 0.02, 0.05, 0.1};                       ///< ε of the inextensibility prior
    std::vector<double> mus{1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3};  ///< μ of the quasistatic prior
    std::optional<LearnMu> learn_mu;    ///< nothing said: per vertex, where every train sample is predicted
    double overstretched_limit = 0.05;  ///< edges beyond (1 + this) times their rest length count as overstretched
    int samples = 0;                    ///< of each split at most, drawn by the data set's seed; 0: all
    int shown = 12;                     ///< samples that are kept to look at
    int jobs = 1;                       ///< threads; the results do not depend on it
    std::string command;                ///< said in the results
    generate::ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between batches

    /// Throws Error naming the flag.
    void validate() const;
};

/// A sample that a prior did not solve to its accuracy, or whose values are not finite. It counts all the same, with
/// the best that was found.
struct AccuracyFailure {
    std::string predictor, method;
    std::int64_t id;
    std::string what;
};

struct AccuracySummary {
    std::string results, figures_file;  ///< paths of accuracy.json and accuracy.h5
    int vertices = 0;
    std::vector<JudgedSplit> split;
    AccuracyFigures figures;
    AccuracyVerdicts verdicts;
    std::optional<NoiseFloor> floor;
    std::vector<LearnedMu> mu;  ///< in the order of the predictors; empty where none was learned
    std::vector<AccuracyFailure> failure;
    std::vector<std::string> remark;  ///< what a reader of the tables should know, one sentence each
    double seconds = 0;               ///< of the whole run
};

/// How far predicted cloth is from the truth, as it is and after both priors, for each split (paper, Tables 1-4).
///
/// Judges the accepted samples against `/samples/cloth` and against the body in their pose. Memory does not grow with
/// the number of samples beyond their values. Writes accuracy.json and accuracy.h5 whole or not at all; their bytes
/// depend on the inputs and the data set's seed alone, not on `jobs`. Throws Error for what is wrong with the inputs.
AccuracySummary evaluate_accuracy(const AccuracyOptions& options);

}  // namespace toile::evaluate

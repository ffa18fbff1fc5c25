#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"
#include "generate/progress.h"

namespace toile::evaluate {

struct RuntimeOptions {
    std::string dataset;               ///< data set file
    RuntimePredictions predictions;    ///< what the priors are given
    std::string folder;                ///< for runtime.json
    std::vector<std::string> studies;  ///< of `study_names`; empty: all
    bool quick = false;                ///< small versions of all studies
    int samples = 0;                   ///< that are measured; 0: 8, with `quick` 2
    int rounds = 0;                    ///< that each is timed, at most; 0: 5, with `quick` 2
    std::string command;               ///< as it was given, for runtime.json
    Clock clock = processor_clock();   ///< of what one thread does
    Clock wall = wall_clock();         ///< of what several threads do
    generate::ProgressCallback progress = {};
    const std::atomic<bool>* interrupted = nullptr;
};

struct RuntimeSummary {
    std::string file;  ///< runtime.json
    std::vector<Study> study;
    double seconds = 0;

    int refused() const;  ///< references and results that there are not
};

/// "priors", "gradients", "solvers", "voxel", "image", "mesh", "batch".
const std::vector<std::string>& study_names();

/// Measures error against run time on a few seeded samples of a data set, all methods in one run, and writes
/// runtime.json, whole or not at all. Throws Error for an unknown study, a data set without accepted samples, a folder
/// that cannot be written to; generate::Interrupted once `interrupted` is set.
RuntimeSummary evaluate_runtime(const RuntimeOptions& options);

/// All of it for a terminal.
std::string runtime_table(const RuntimeSummary& summary);

}  // namespace toile::evaluate

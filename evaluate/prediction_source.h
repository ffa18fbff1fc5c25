#pragma once

#include <functional>
#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "files/predictions_file.h"

namespace toile::evaluate {

/// A predictor that is judged: a predictions file, or one that is built in and fitted.
struct PredictionSource {
    std::string name;                                                     ///< in tables and metrics; unique
    std::string about;                                                    ///< the file, or what was fitted
    std::function<Positions(const files::SampleRecord& sample)> predict;  ///< r̂ `[V x 3]` [m]; one thread at a time
    /// Why nothing can be learned from its predictions of the train split; empty where it can.
    std::string why_no_train;
};

/// Predictors from files, checked against the data set's accepted samples of `splits`; without files the built-in ones,
/// fitted on its train split. Throws Error for what is wrong with a file, and where two predictors have one name.
std::vector<PredictionSource> prediction_sources(const std::vector<std::string>& paths,
                                                 const files::DatasetReader& dataset, const std::vector<int>& splits);

}  // namespace toile::evaluate

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cloth/types.h"

namespace toile::evaluate {

/// Predictions for the data set at `dataset`, any of them: its cloth, shaken by `size` [m], under the predictor's name
/// `name` (none: no attribute). `change` may damage what is written.
struct TestPredictions {
    double size = 0.003;
    std::string name = "shaken";
    std::function<void(std::vector<std::int64_t>& id, std::vector<float>& predicted)> change =
        [](std::vector<std::int64_t>&, std::vector<float>&) {};

    void write(const std::string& path, const std::string& dataset) const;
};

/// A data set of a cloth without a body: `samples` of one grid, each bent otherwise, spread over the splits in turn
/// (two of three in train).
void write_bodiless_dataset(const std::string& path, int samples);

}  // namespace toile::evaluate

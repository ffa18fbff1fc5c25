#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "prior/rest_state.h"

namespace toile::evaluate {

/// Where the predictions of the samples come from.
struct RuntimePredictions {
    std::string file;        ///< a predictions file, or empty: the truth with seeded noise
    double noise = 0.005;    ///< of the truth with noise: root mean square over the vertices [m]
    std::uint64_t seed = 1;  ///< of the noise, and of the choice of samples
};

/// The samples that all studies measure: a few, in memory.
struct RuntimeSamples {
    files::DatasetHeader header;
    prior::RestState rest;
    std::vector<files::SampleRecord> record;     ///< `[N]` ascending by id
    std::vector<std::vector<double>> target;     ///< `[N]` of `[V x 3]` r_T [m]
    std::vector<std::vector<double>> predicted;  ///< `[N]` of `[V x 3]` r̂ [m]
    std::string predictions;                     ///< where r̂ comes from, for the reader
    int accepted = 0;                            ///< samples the data set has that could have been chosen

    int count() const { return static_cast<int>(record.size()); }
    int vertex_count() const { return rest.vertex_count; }
};

/// Draws at most `count` of a data set's accepted samples by the seed (a larger draw holds the smaller) and gives each
/// its prediction. Throws Error for a data set without accepted samples, and for what is wrong with the predictions.
RuntimeSamples read_runtime_samples(const std::string& dataset, int count, const RuntimePredictions& predictions);

/// A cloth `[V x 3]` off by `rms` [m] (root mean square over its vertices): eight ninths of its square are waves of a
/// quarter of the cloth to twice its size, a ninth is white noise, its size scaled by `roughness`. `rest` `[V x 3]` is
/// where the waves live: the same error on a finer mesh is the same error.
Positions noisy_cloth(const Positions& cloth, const Positions& rest, double rms, double roughness, std::uint64_t seed);

}  // namespace toile::evaluate

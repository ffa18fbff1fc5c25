#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "evaluate/predictor_data.h"

namespace toile::evaluate {

struct ComponentOptions {
    int components = 0;  ///< 1 or more; 0: as many as hold `explained_variance`, at most `most`
    double explained_variance = 0.999;
    int most = 128;
    std::uint64_t seed = 1;
    int jobs = 1;
};

/// Principal components of the displacements of the train split, M = 3 V numbers each:
///     d = mean + direction · t + what is left.
struct DisplacementComponents {
    Eigen::VectorXd mean;       ///< `[M]` over all of the train split [m]
    Eigen::MatrixXd direction;  ///< `[M x k]` orthonormal, by falling variance; k may be less than asked for
    int drawn = 0;              ///< samples the directions were taken from
};

/// Mean displacement `[V x 3]` of the train split, which must not be empty [m].
Positions mean_displacement(const PredictorData& data);

/// The largest number of samples that directions are taken from.
inline constexpr int most_drawn = 1024;

/// By the Gram matrix of the train samples: exact for up to `most_drawn` of them; of more, directions are those of
/// `most_drawn` drawn by the seed, while the mean is that of all. So memory is bounded, however many samples there are:
/// 4 · most_drawn · M bytes, 36 MB for 2,969 vertices, and 8 M k for the directions. One pass over the samples, and one
/// over those drawn. `jobs` changes nothing but the time.
DisplacementComponents displacement_components(const PredictorData& data, const ComponentOptions& options);

}  // namespace toile::evaluate

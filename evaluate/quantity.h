#pragma once

#include <array>

#include "files/metric_file.h"

namespace toile::evaluate {

/// What is asked of a cloth beside its target, in the order of tables.
enum class Quantity {
    sqrt_mse,  ///< of one sample: √(mean over vertices of |r − r_T|²); of several: the root of the mean of its squares
    max_dist,           ///< largest distance of a vertex from its target
    stretching_energy,  ///< Σ ½ k_e (l_e − l̄_e)² over edges longer than at rest, k_e as in the quasistatic prior
    compression_energy,        ///< the same over the shorter ones
    stretching_energy_error,   ///< |E(r) − E(r_T)|
    compression_energy_error,  ///< the same
    normal_error,              ///< mean angle between area-weighted vertex normals
    overstretched_share,       ///< of the edges: longer than (1 + limit) l̄_e
    largest_stretch,           ///< largest l_e / l̄_e
    penetration                ///< of the deepest vertex below the body's surface
};
inline constexpr int quantity_count = 10;

/// A sample's values, in the units of `quantity_kind`; NaN where there is none.
using QuantityValues = std::array<double, quantity_count>;

struct QuantityKind {
    const char* name;   ///< "sqrt_mse"
    const char* title;  ///< "SqrtMSE"
    const char* unit;   ///< "mm"
    files::MetricDirection direction;
    bool root_of_squares;  ///< samples are put together by the root of their mean square, not by the mean
    bool of_the_cloth;     ///< says what the cloth is like, not how far it is from its target
    const char* meaning;   ///< one sentence, for who reads a table
};

const QuantityKind& quantity_kind(int quantity);
inline const QuantityKind& quantity_kind(Quantity quantity) {
    return quantity_kind(static_cast<int>(quantity));
}
inline double& at(QuantityValues& values, Quantity quantity) {
    return values[static_cast<size_t>(quantity)];
}
inline double at(const QuantityValues& values, Quantity quantity) {
    return values[static_cast<size_t>(quantity)];
}

}  // namespace toile::evaluate

#include "evaluate/quantity.h"

namespace toile::evaluate {

using files::MetricDirection;

const QuantityKind& quantity_kind(int quantity) {
    static const std::array<QuantityKind, quantity_count> kinds{{
        {"sqrt_mse", "SqrtMSE", "mm", MetricDirection::lower, true, false,
         "root of the mean over samples and vertices of the squared distance to the target"},
        {"max_dist", "MaxDist", "mm", MetricDirection::lower, false, false,
         "mean over samples of the largest distance of a vertex to its target"},
        {"stretching_energy", "stretching energy", "J", MetricDirection::none, false, true,
         "of the quasistatic model's edge springs that are longer than at rest"},
        {"compression_energy", "compression energy", "J", MetricDirection::none, false, true,
         "of the quasistatic model's edge springs that are shorter than at rest"},
        {"stretching_energy_error", "stretching energy error", "J", MetricDirection::lower, false, false,
         "mean over samples of the difference to the target's stretching energy, without its sign"},
        {"compression_energy_error", "compression energy error", "J", MetricDirection::lower, false, false,
         "mean over samples of the difference to the target's compression energy, without its sign"},
        {"normal_error", "normal error", "deg", MetricDirection::lower, false, false,
         "mean angle between the vertex normals of cloth and target"},
        {"overstretched_share", "overstretched edges", "%", MetricDirection::lower, false, true,
         "share of the edges that are longer than the limit"},
        {"largest_stretch", "largest stretch", "ratio", MetricDirection::lower, false, true,
         "mean over samples of the largest edge length over rest length"},
        {"penetration", "penetration", "mm", MetricDirection::lower, false, true,
         "mean over samples of the depth of the deepest vertex below the body's surface"},
    }};
    return kinds.at(static_cast<size_t>(quantity));
}

}  // namespace toile::evaluate

#include "simulate/xpbd_bending.h"

#include <cmath>

namespace toile::simulate {
namespace {

constexpr int weights = 0, stiffness_at = 4, constant_count = 5;

struct Points {
    Lane8 x[4][3];
};

[[gnu::always_inline]] inline Points gather_points(const XpbdBatch<4>& batch, const double* x) {
    Points points;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) points.x[i][c] = gather_lanes(x, 3, batch.vertex[i], c);
    return points;
}

[[gnu::always_inline]] inline Lane8 constant(const double* constants, int which) {
    return load_lanes<8>(constants + which * xpbd_lanes);
}

[[gnu::always_inline]] inline void curvature_of(const double* constants, const Points& points, Lane8 (&curvature)[3]) {
    for (int c = 0; c < 3; ++c) {
        curvature[c] = constant(constants, weights) * points.x[0][c];
        for (int i = 1; i < 4; ++i) curvature[c] += constant(constants, weights + i) * points.x[i][c];
    }
}

/// The part of v along a direction; all of it where there is none.
[[gnu::always_inline]] inline void turn_along(const Lane8 (&direction)[3], Lane8 (&v)[3]) {
    const Lane8 zero = lane_broadcast<8>(0.0);
    Lane8 squared = zero, product = zero;
    for (int c = 0; c < 3; ++c) {
        squared += direction[c] * direction[c];
        product += direction[c] * v[c];
    }
    const LaneMask8 has = lane_less(zero, squared);
    const Lane8 share = product / lane_select(has, squared, lane_broadcast<8>(1.0));
    for (int c = 0; c < 3; ++c) v[c] = lane_select(has, share * direction[c], v[c]);
}

[[gnu::always_inline]] inline Lane8 yield_of(const XpbdBatch<4>& batch, const double* constants,
                                             const double* inverse_mass) {
    Lane8 sum = lane_broadcast<8>(0.0);
    for (int i = 0; i < 4; ++i) {
        const Lane8 weight = constant(constants, weights + i);
        sum += gather_lanes(inverse_mass, 1, batch.vertex[i], 0) * weight * weight;
    }
    return sum;
}

TOILE_LANE_KERNEL void begin_batches(const XpbdBatch<4>* batch, int count, const double* constants, const double* start,
                                     double* force, double* total) {
    for (int b = 0; b < count; ++b, ++batch, constants += constant_count * xpbd_lanes) {
        Lane8 curvature[3], f[3];
        curvature_of(constants, gather_points(*batch, start), curvature);
        for (int c = 0; c < 3; ++c) f[c] = gather_lanes(force, 3, batch->item, c);
        turn_along(curvature, f);
        for (int c = 0; c < 3; ++c) {
            scatter_lanes(f[c], force, 3, batch->item, c, batch->count);
            for (int i = 0; i < 4; ++i)
                scatter_add_lanes(-constant(constants, weights + i) * f[c], total, 3, batch->vertex[i], c,
                                  batch->count);
        }
    }
}

TOILE_LANE_KERNEL void sweep_batches(const XpbdBatch<4>* batch, int count, const double* constants, double q,
                                     const double* inverse_mass, const double* start, double* force, double* x) {
    for (int b = 0; b < count; ++b, ++batch, constants += constant_count * xpbd_lanes) {
        const Points points = gather_points(*batch, x);
        Lane8 begun[3], change[3], f[3];
        curvature_of(constants, gather_points(*batch, start), begun);
        curvature_of(constants, points, change);
        const Lane8 stiffness = constant(constants, stiffness_at);
        for (int c = 0; c < 3; ++c) {
            f[c] = gather_lanes(force, 3, batch->item, c);
            change[c] = stiffness * change[c] - f[c];
        }
        turn_along(begun, change);
        const Lane8 softer = 1.0 / (1.0 + q * stiffness * yield_of(*batch, constants, inverse_mass));
        for (int c = 0; c < 3; ++c) {
            change[c] *= softer;
            scatter_lanes(f[c] + change[c], force, 3, batch->item, c, batch->count);
        }
        for (int i = 0; i < 4; ++i) {
            const Lane8 move =
                q * gather_lanes(inverse_mass, 1, batch->vertex[i], 0) * constant(constants, weights + i);
            for (int c = 0; c < 3; ++c)
                scatter_lanes(points.x[i][c] - move * change[c], x, 3, batch->vertex[i], c, batch->count);
        }
    }
}

TOILE_LANE_KERNEL void follow_batches(const XpbdBatch<4>* batch, int count, const double* constants, double q,
                                      const double* inverse_mass, const double* reached, double* kept) {
    for (int b = 0; b < count; ++b, ++batch, constants += constant_count * xpbd_lanes) {
        const Lane8 stiff = q * constant(constants, stiffness_at) * yield_of(*batch, constants, inverse_mass);
        const Lane8 share = largest_kept_stiffness / lane_max(stiff, lane_broadcast<8>(largest_kept_stiffness));
        for (int c = 0; c < 3; ++c) {
            const Lane8 before = gather_lanes(kept, 3, batch->item, c);
            const Lane8 after = before + share * (gather_lanes(reached, 3, batch->item, c) - before);
            scatter_lanes(after, kept, 3, batch->item, c, batch->count);
        }
    }
}

}  // namespace

void XpbdBending::add(const std::array<int, 4>& vertex, const std::array<double, 4>& weight, double stiffness) {
    vertex_.push_back(vertex);
    weight_.push_back(weight);
    stiffness_.push_back(stiffness);
}

void XpbdBending::finish() {
    batch_ = make_batches<4>(vertex_);
    constants_ = LaneArray(batch_.size() * constant_count * xpbd_lanes);
    for (size_t b = 0; b < batch_.size(); ++b) {
        double* constants = constants_.data() + b * constant_count * xpbd_lanes;
        for (int lane = 0; lane < xpbd_lanes; ++lane) {
            const int item = batch_[b].item[lane];
            for (int i = 0; i < 4; ++i) constants[(weights + i) * xpbd_lanes + lane] = weight_[item][i];
            constants[stiffness_at * xpbd_lanes + lane] = stiffness_[item];
        }
    }
}

void XpbdBending::begin(const Positions& start, Positions& force, Positions& total) const {
    begin_batches(batch_.data(), static_cast<int>(batch_.size()), constants_.data(), start.data(), force.data(),
                  total.data());
}

void XpbdBending::sweep(const XpbdMobility& mobility, const Positions& start, Positions& force, Positions& x) const {
    sweep_batches(batch_.data(), static_cast<int>(batch_.size()), constants_.data(), mobility.squared_time,
                  mobility.inverse_mass.data(), start.data(), force.data(), x.data());
}

void XpbdBending::follow(const XpbdMobility& mobility, const Positions& reached, Positions& kept) const {
    follow_batches(batch_.data(), static_cast<int>(batch_.size()), constants_.data(), mobility.squared_time,
                   mobility.inverse_mass.data(), reached.data(), kept.data());
}

void XpbdBending::add_stiffness(Eigen::VectorXd& stiffness) const {
    for (size_t k = 0; k < vertex_.size(); ++k) {
        double sum = 0.0;
        for (double weight : weight_[k]) sum += std::abs(weight);
        for (int i = 0; i < 4; ++i) stiffness[vertex_[k][i]] += stiffness_[k] * sum * std::abs(weight_[k][i]);
    }
}

}  // namespace toile::simulate

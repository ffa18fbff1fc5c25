#include "simulate/trust_region.h"

#include <algorithm>
#include <cmath>

namespace toile::simulate {
namespace {

constexpr int most_iterations = 20;
/// The model is minimised until its residual has fallen to this share: further from the minimum more would be lost.
constexpr double forcing = 0.3;
/// A way along which H curves upwards by less than this share of P counts as one that curves downwards.
constexpr double least_curvature = 1e-3;
/// The first radius over the length of Newton's step with P.
constexpr double first_radius = 3.0;
/// A step that lowered the objective by less than `poor` of what was foretold halves the radius, one by more than
/// `good` that ended at the rim doubles it.
constexpr double poor = 0.25, good = 0.6;

double dot(const Positions& a, const Positions& b) {
    return a.cwiseProduct(b).sum();
}

}  // namespace

void TrustRegion::improve(const Positions& gradient, const Operator& multiply, const Operator& precondition,
                          Positions& direction) {
    residual_ = -gradient;
    way_ = direction;
    product_.resizeLike(direction);
    preconditioned_.resizeLike(direction);
    double slope = dot(residual_, direction);  // r·P⁻¹r
    const double first = slope;
    if (!(radius_ > 0.0)) radius_ = first_radius * std::sqrt(first);
    direction.setZero();
    decrease_ = 0.0;
    at_rim_ = false;
    // In the norm of P: the step's length, the way's, and their product (Conn, Gould and Toint 2000, section 7.5.1).
    double squared = 0.0, outward = 0.0, way_squared = slope;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        multiply(way_, product_);
        const double curvature = dot(way_, product_);
        const bool curves_up = curvature > least_curvature * way_squared;
        const double share = curves_up ? slope / curvature : 0.0;
        const double next_squared = squared + 2.0 * share * outward + share * share * way_squared;
        if (!curves_up || next_squared >= radius_ * radius_) {
            const double room = radius_ * radius_ - squared;
            const double rim = (std::sqrt(outward * outward + way_squared * room) - outward) / way_squared;
            direction += rim * way_;
            decrease_ += rim * slope - 0.5 * rim * rim * curvature;
            squared = radius_ * radius_;
            at_rim_ = true;
            break;
        }
        direction += share * way_;
        decrease_ += 0.5 * share * slope;
        squared = next_squared;
        residual_ -= share * product_;
        precondition(residual_, preconditioned_);
        const double next_slope = dot(residual_, preconditioned_);
        if (next_slope < forcing * forcing * first) break;
        const double keep = next_slope / slope;
        way_ = preconditioned_ + keep * way_;
        outward = keep * (outward + share * way_squared);
        way_squared = next_slope + keep * keep * way_squared;
        slope = next_slope;
    }
    length_ = std::sqrt(squared);
}

void TrustRegion::learn(double share, double decrease) {
    if (share < 1.0) {
        radius_ = std::min(radius_, share * length_);
    } else if (decrease < poor * decrease_) {
        radius_ = std::min(radius_, 0.5 * length_);
    } else if (decrease > good * decrease_ && at_rim_) {
        radius_ *= 2.0;
    }
}

}  // namespace toile::simulate

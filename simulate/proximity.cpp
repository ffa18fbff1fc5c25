#include "simulate/proximity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace toile::simulate {
namespace {

using Eigen::Vector3d;

// Squared sine below which a triangle or a pair of edges counts as collapsed: its normal is then no better than 1e-8.
constexpr double collapsed = 1e-16;

// Of a squared length. 0 where that is too small to divide by: the edge is then a point.
double reciprocal(double squared_length) {
    return squared_length > 1e-300 ? 1.0 / squared_length : 0.0;
}

void keep_nearer(Proximity& best, const Vector3d& difference, const std::array<double, 4>& weight) {
    const double squared = difference.squaredNorm();
    if (squared < best.squared_distance) best = {weight, difference, squared};
}

Proximity nothing_yet() {
    return {{}, Vector3d::Zero(), std::numeric_limits<double>::infinity()};
}

// The nearest point of side x[i] x[j] to x[0].
void try_side(const FourPoints& x, int i, int j, Proximity& best) {
    const Vector3d side = x[j] - x[i], to_vertex = x[0] - x[i];
    const double share = std::clamp(to_vertex.dot(side) * reciprocal(side.squaredNorm()), 0.0, 1.0);
    std::array<double, 4> weight = {1.0, 0.0, 0.0, 0.0};
    weight[i] = share - 1.0;
    weight[j] = -share;
    keep_nearer(best, to_vertex - share * side, weight);
}

// Edges as lines: first = x[0] + s d, second = x[2] + t e.
struct EdgePair {
    Vector3d d, e, r;  // r from x[2] to x[0]
    double dd, ee, de, dr, er, over_dd, over_ee;

    explicit EdgePair(const FourPoints& x)
        : d(x[1] - x[0]),
          e(x[3] - x[2]),
          r(x[0] - x[2]),
          dd(d.squaredNorm()),
          ee(e.squaredNorm()),
          de(d.dot(e)),
          dr(d.dot(r)),
          er(e.dot(r)),
          over_dd(reciprocal(dd)),
          over_ee(reciprocal(ee)) {}

    double nearest_on_first(double t) const { return std::clamp((t * de - dr) * over_dd, 0.0, 1.0); }
    double nearest_on_second(double s) const { return std::clamp((s * de + er) * over_ee, 0.0, 1.0); }

    void try_shares(double s, double t, Proximity& best) const {
        keep_nearer(best, r + s * d - t * e, {1.0 - s, s, t - 1.0, -t});
    }
};

}  // namespace

Proximity vertex_triangle_proximity(const FourPoints& x) {
    const Vector3d first = x[2] - x[1], second = x[3] - x[1], to_vertex = x[0] - x[1];
    const Vector3d normal = first.cross(second);
    const double squared_area = normal.squaredNorm();
    const double b1 = to_vertex.cross(second).dot(normal), b2 = first.cross(to_vertex).dot(normal);
    const double b0 = squared_area - b1 - b2;
    const bool flat = squared_area > collapsed * first.squaredNorm() * second.squaredNorm() &&
                      squared_area > collapsed * first.squaredNorm() * (second - first).squaredNorm();
    Proximity best = nothing_yet();
    if (squared_area > 0.0 && b0 >= 0.0 && b1 >= 0.0 && b2 >= 0.0) {
        const double w1 = b1 / squared_area, w2 = b2 / squared_area;
        keep_nearer(best, to_vertex - w1 * first - w2 * second, {1.0, w1 + w2 - 1.0, -w1, -w2});
        if (flat) return best;
    }
    // Only sides that the vertex sees can be nearest.
    if (!flat || b2 < 0.0) try_side(x, 1, 2, best);
    if (!flat || b0 < 0.0) try_side(x, 2, 3, best);
    if (!flat || b1 < 0.0) try_side(x, 3, 1, best);
    return best;
}

Proximity edge_edge_proximity(const FourPoints& x) {
    const EdgePair pair(x);
    const Vector3d normal = pair.d.cross(pair.e);
    const double squared_normal = normal.squaredNorm();
    Proximity best = nothing_yet();
    if (squared_normal > 0.0) {
        // By cross products: dd ee - de² would lose twice the digits where the edges are nearly parallel.
        const double s = std::clamp(-pair.r.cross(pair.e).dot(normal) / squared_normal, 0.0, 1.0);
        const double t = pair.nearest_on_second(s);
        // Once more, in case t was clamped; where it was not, this leaves s as it is but for rounding.
        pair.try_shares(pair.nearest_on_first(t), t, best);
        if (squared_normal > collapsed * pair.dd * pair.ee) return best;
    }
    for (const double s : {0.0, 1.0}) pair.try_shares(s, pair.nearest_on_second(s), best);
    for (const double t : {0.0, 1.0}) pair.try_shares(pair.nearest_on_first(t), t, best);
    return best;
}

double vertex_triangle_separation(const Vector3d& direction, const FourPoints& x) {
    return std::min({direction.dot(x[0] - x[1]), direction.dot(x[0] - x[2]), direction.dot(x[0] - x[3])});
}

double edge_edge_separation(const Vector3d& direction, const FourPoints& x) {
    return std::min({direction.dot(x[0] - x[2]), direction.dot(x[0] - x[3]), direction.dot(x[1] - x[2]),
                     direction.dot(x[1] - x[3])});
}

ParallelMollifier parallel_mollifier(const FourPoints& x, double threshold) {
    const double c = (x[1] - x[0]).cross(x[3] - x[2]).squaredNorm();
    if (!(c < threshold)) return {1.0, 0.0, c};
    const double share = c / threshold;
    return {share * (2.0 - share), 2.0 * (1.0 - share) / threshold, c};
}

FourPoints squared_cross_gradient(const FourPoints& x) {
    const Vector3d d = x[1] - x[0], e = x[3] - x[2], cross = d.cross(e);
    const Vector3d by_first = 2.0 * e.cross(cross), by_second = 2.0 * cross.cross(d);
    return {-by_first, by_first, -by_second, by_second};
}

}  // namespace toile::simulate

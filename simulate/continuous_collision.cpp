#include "simulate/continuous_collision.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile::simulate {
namespace {

using Eigen::Vector3d;

// What the two kinds of pairs differ in: how many of the four points are the first feature's.
template <int FirstCount>
struct Kind;
template <>
struct Kind<1> {
    static Proximity proximity(const FourPoints& x) { return vertex_triangle_proximity(x); }
};
template <>
struct Kind<2> {
    static Proximity proximity(const FourPoints& x) { return edge_edge_proximity(x); }
};

template <int FirstCount, typename Visit>
void each_vertex_pair(Visit&& visit) {
    for (int i = 0; i < FirstCount; ++i)
        for (int j = FirstCount; j < 4; ++j) visit(i, j);
}

// The nearest points' relative velocity is a mean of the vertices' relative velocities, so none is larger than this.
template <int FirstCount>
double largest_relative_motion(const FourPoints& motion) {
    double squared = 0.0;
    each_vertex_pair<FirstCount>(
        [&](int i, int j) { squared = std::max(squared, (motion[i] - motion[j]).squaredNorm()); });
    return std::sqrt(squared);
}

// How long all vertices of the first feature stay `kept` in front of all of the second, along a unit direction.
template <int FirstCount>
double time_in_front(const Vector3d& direction, const FourPoints& x, const FourPoints& motion, double kept) {
    std::array<double, 4> height, speed;
    for (int i = 0; i < 4; ++i) {
        height[i] = direction.dot(x[i]);
        speed[i] = direction.dot(motion[i]);
    }
    double time = std::numeric_limits<double>::infinity();
    each_vertex_pair<FirstCount>([&](int i, int j) {
        const double approach = speed[j] - speed[i], gap = height[i] - height[j] - kept;
        if (gap < 0.0) time = 0.0;
        if (approach > 0.0) time = std::min(time, gap / approach);
    });
    return std::max(time, 0.0);
}

// Distances below this are rounding of the positions, before and after the motion.
double rounding(const FourPoints& x, const FourPoints& motion) {
    double sum = 0.0;  // not the largest: a sum lets no NaN pass
    for (int i = 0; i < 4; ++i) sum += x[i].cwiseAbs().sum() + motion[i].cwiseAbs().sum();
    return 2.0 * std::numeric_limits<double>::epsilon() * sum;
}

template <int FirstCount>
double pair_safe_share(const FourPoints& x, const FourPoints& motion, const SafeMotionOptions& options, double limit) {
    const double noise = rounding(x, motion);
    if (!(noise < std::numeric_limits<double>::infinity()) || !(limit > 0.0)) return 0.0;
    // Relative to the first vertex: neither a common place nor a common motion costs digits.
    FourPoints start, relative;
    for (int i = 0; i < 4; ++i) {
        start[i] = x[i] - x[0];
        relative[i] = motion[i] - motion[0];
    }
    const double speed = largest_relative_motion<FirstCount>(relative);
    if (speed <= noise) return limit;

    Proximity nearest = Kind<FirstCount>::proximity(start);
    double distance = nearest.distance();
    const double separation = distance > options.separation ? options.separation : 0.0;
    const double remaining = std::min(options.remaining_share * (distance - separation), options.largest_remaining);
    const double kept = std::max(separation + remaining, noise);
    const double near_enough = kept + 0.5 * (kept - separation);
    double share = 0.0;
    FourPoints now = start;
    for (int step = 0; step < options.steps && distance > std::max(kept, step > 0 ? near_enough : 0.0); ++step) {
        const double in_front = time_in_front<FirstCount>(nearest.difference / distance, now, relative, kept);
        // Where the distance is near rounding, the direction isn't exact enough to prove what the distance itself does.
        const double by_speed = (distance - kept - noise) / speed;
        const double longer = std::max({in_front, by_speed, 0.0});
        if (share + longer >= limit) return limit;
        if (share + longer == share) break;
        share += longer;
        for (int i = 0; i < 4; ++i) now[i] = start[i] + share * relative[i];
        nearest = Kind<FirstCount>::proximity(now);
        distance = nearest.distance();
    }
    return share;
}

}  // namespace

double vertex_triangle_safe_share(const FourPoints& x, const FourPoints& motion, const SafeMotionOptions& options,
                                  double limit) {
    return pair_safe_share<1>(x, motion, options, limit);
}

double edge_edge_safe_share(const FourPoints& x, const FourPoints& motion, const SafeMotionOptions& options,
                            double limit) {
    return pair_safe_share<2>(x, motion, options, limit);
}

double safe_share(const CandidatePairs& pairs, const Positions& x, const Positions& motion,
                  const SafeMotionOptions& options, double limit) {
    // A pair's steps don't depend on the limit, only where they end: so the order of the pairs doesn't matter.
    for (const auto& pair : pairs.vertex_triangle)
        limit = vertex_triangle_safe_share(gather(x, pair.point), gather(motion, pair.point), options, limit);
    for (const auto& pair : pairs.edge_edge)
        limit = edge_edge_safe_share(gather(x, pair.point), gather(motion, pair.point), options, limit);
    return limit;
}

}  // namespace toile::simulate

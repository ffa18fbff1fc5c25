#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "prior/newton_lanes.h"

// How samples get into the lanes of `NewtonLanes` and out of them.

namespace toile::prior {
namespace {

constexpr double shake_size = 1e-3;  // of an edge
constexpr double flatness = 1e-4;    // thickness of a prediction that counts as a plane, of an edge

/// From -1 to 1, the same for the same number always (splitmix64).
double fixed_noise(std::uint64_t number) {
    std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace

/// Brings the lane's sample in; false if it is not finite.
template <int W>
bool NewtonLanes<W>::load(int l) {
    const QuasistaticSample& sample = lane_[l].sample;
    const auto finite = [this](const double* x) {
        return std::all_of(x, x + size_, [](double y) { return std::isfinite(y); });
    };
    if (!finite(sample.predicted)) {
        std::fill_n(sample.position, size_, std::numeric_limits<double>::quiet_NaN());
        *sample.report = Report{};
        return false;
    }
    // Sums of shares: no overflow, whatever the positions.
    double mean[3] = {};
    for (int i = 0; i < size_; ++i) mean[i % 3] += sample.predicted[i] / graph_.vertex_count;
    for (int c = 0; c < 3; ++c) origin_[W * c + l] = mean[c] / graph_.length_unit;
    const auto bring = [&](const double* from, LaneArray& to) {
        for (int i = 0; i < size_; ++i)
            to[static_cast<size_t>(i) * W + l] =
                from[3 * graph_.vertex[i / 3] + i % 3] / graph_.length_unit - origin_[W * (i % 3) + l];
    };
    bring(sample.predicted, predicted_);
    bring(sample.predicted, position_);
    return true;
}

/// Brings a fresh lane to where it starts; true if that is not the prediction.
template <int W>
bool NewtonLanes<W>::start(int l) {
    const Lane& lane = lane_[l];
    const double* from = lane.sample.start;
    if (from && std::all_of(from, from + size_, [](double x) { return std::isfinite(x); })) {
        for (int i = 0; i < size_; ++i)
            position_[static_cast<size_t>(i) * W + l] =
                from[3 * graph_.vertex[i / 3] + i % 3] / graph_.length_unit - origin_[W * (i % 3) + l];
        return true;
    }
    if (std::max(value_.largest[l], value_.lost[l]) <= rules_.tolerance * lane.scale) return false;
    if (value_.lost[l] == 0.0 && !is_flat(l)) return false;
    for (int i = 0; i < size_; ++i)
        position_[static_cast<size_t>(i) * W + l] +=
            shake_size * fixed_noise(static_cast<std::uint64_t>(3 * graph_.vertex[i / 3] + i % 3));
    return true;
}

/// Whether the prediction lies in a plane.
template <int W>
bool NewtonLanes<W>::is_flat(int l) const {
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (int i = 0; i < size_; i += 3) {
        const double* at = predicted_.data() + static_cast<size_t>(i) * W + l;
        const Eigen::Vector3d x(at[0], at[W], at[2 * W]);
        moment += x * x.transpose() / graph_.vertex_count;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moment, Eigen::EigenvaluesOnly);
    const double largest = moment.trace();
    return solver.eigenvalues()[0] <= std::max(flatness * flatness, 1e-12 * largest);
}

template <int W>
void NewtonLanes<W>::finish(Lane& lane, int l) {
    for (int i = 0; i < size_; ++i)
        lane.sample.position[3 * graph_.vertex[i / 3] + i % 3] =
            graph_.length_unit * (position_[static_cast<size_t>(i) * W + l] + origin_[W * (i % 3) + l]);
    Report& report = lane.report;
    report.seconds_sweep += lane.seconds[sweep];
    report.seconds_assembly += lane.seconds[assembly];
    report.seconds_factor += lane.seconds[factor];
    report.seconds_solve += lane.seconds[preconditioning];
    report.seconds +=
        lane.seconds[sweep] + lane.seconds[assembly] + lane.seconds[factor] + lane.seconds[preconditioning];
    *lane.sample.report = report;
    if (report.status != Status::converged) (*give_up_)(lane.number);
    lane.number = -1;
    --active_;
}

template bool NewtonLanes<1>::load(int);
template bool NewtonLanes<8>::load(int);
template bool NewtonLanes<1>::start(int);
template bool NewtonLanes<8>::start(int);
template bool NewtonLanes<1>::is_flat(int) const;
template bool NewtonLanes<8>::is_flat(int) const;
template void NewtonLanes<1>::finish(Lane&, int);
template void NewtonLanes<8>::finish(Lane&, int);

}  // namespace toile::prior

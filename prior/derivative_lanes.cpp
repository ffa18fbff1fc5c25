#include "prior/derivative_lanes.h"

#include <algorithm>
#include <cmath>

#include "prior/spring_lanes.h"
#include "prior/vector_lanes.h"

namespace toile::prior {
namespace {

constexpr double goal = 1e-12;  // of the residual's largest entry, relative to the right-hand side's
constexpr int max_rounds = 8;
constexpr double accepted = 1e-8;  // what counts as solved

bool all_finite(const double* x, int size) {
    return std::all_of(x, x + size, [](double y) { return std::isfinite(y); });
}

}  // namespace

template <int W>
DerivativeLanes<W>::DerivativeLanes(const SpringGraph& graph, std::unique_ptr<LinearSweeps<W>> sweeps,
                                    const DerivativeRules& rules)
    : graph_(graph), sweeps_(std::move(sweeps)), rules_(rules), size_(3 * graph.vertex_count) {
    for (LaneArray* vector : {&predicted_, &position_, &right_side_, &solution_, &residual_, &correction_, &product_})
        *vector = LaneArray(static_cast<size_t>(size_) * W);
}

template <int W>
void DerivativeLanes<W>::clear() {
    loaded_.fill(false);
    report_.fill(DerivativeReport{});
    for (LaneArray* vector : {&predicted_, &position_, &right_side_}) std::fill_n(vector->data(), vector->size(), 0.0);
}

template <int W>
bool DerivativeLanes<W>::load(int lane, const double* predicted, const double* position) {
    if (!all_finite(predicted, size_) || !all_finite(position, size_)) return false;
    double mean[3] = {};
    for (int i = 0; i < size_; ++i) mean[i % 3] += position[i] / graph_.vertex_count;
    for (int i = 0; i < graph_.vertex_count; ++i) {
        const int from = 3 * graph_.vertex[i];
        for (int c = 0; c < 3; ++c) {
            const size_t to = static_cast<size_t>(3 * i + c) * W + static_cast<size_t>(lane);
            predicted_[to] = (predicted[from + c] - mean[c]) / graph_.length_unit;
            position_[to] = (position[from + c] - mean[c]) / graph_.length_unit;
        }
    }
    loaded_[lane] = true;
    return true;
}

template <int W>
void DerivativeLanes<W>::unload(int lane) {
    loaded_[lane] = false;
    for (LaneArray* vector : {&predicted_, &position_, &right_side_})
        for (int i = 0; i < size_; ++i) (*vector)[static_cast<size_t>(i) * W + static_cast<size_t>(lane)] = 0.0;
}

template <int W>
bool DerivativeLanes<W>::set_right_side(int lane, const double* from) {
    if (!all_finite(from, size_)) return false;
    for (int i = 0; i < graph_.vertex_count; ++i)
        for (int c = 0; c < 3; ++c)
            right_side_[static_cast<size_t>(3 * i + c) * W + static_cast<size_t>(lane)] =
                from[3 * graph_.vertex[i] + c];
    return true;
}

template <int W>
void DerivativeLanes<W>::build() {
    sweeps_->linearize(position_.data(), exact_, exact_factor_);
    sweeps_->factor(exact_factor_, lost_pivot_);
}

template <int W>
void DerivativeLanes<W>::factor() {
    indefinite_.fill(false);
    std::fill_n(exact_, W, 1.0);
    std::fill_n(exact_factor_, W, 1.0);
    build();
    bool lost = false;
    for (int l = 0; l < W; ++l) {
        if (!loaded_[l] || lost_pivot_[l] == 0.0) continue;
        lost = true;
        exact_factor_[l] = 0.0;
        if (!rules_.complete_factor) continue;  // the system stays exact, with the projected Hessian's preconditioner
        exact_[l] = 0.0;
        indefinite_[l] = true;
    }
    if (lost) build();
}

/// Scales each lane's right-hand side to a largest entry of one: no sum over- or underflows.
template <int W>
void DerivativeLanes<W>::normalize() {
    largest_in_lanes<W>(size_, right_side_.data(), size_of_right_side_);
    for (int l = 0; l < W; ++l) {
        const double size = size_of_right_side_[l];
        used_[l] = loaded_[l] && size > 0.0 && std::isfinite(size);
        length_[l] = used_[l] ? 1.0 / size : 0.0;
    }
    scale_lanes<W>(size_, length_, right_side_.data());
}

template <int W>
bool DerivativeLanes<W>::any_sweeping() const {
    return std::any_of(sweeping_.begin(), sweeping_.end(), [](bool sweeping) { return sweeping; });
}

/// Conjugate gradients for the correction of the lanes that are `sweeping_`, each to `rules_.reduction` of its residual
/// or to the goal. A lane that meets negative curvature is given up.
template <int W>
void DerivativeLanes<W>::sweep() {
    double enough[W];
    sweeps_->begin(residual_.data(), r_dot_z_, squared_, sweep_largest_);
    for (int l = 0; l < W; ++l) enough[l] = sweep_largest_[l] * std::max(rules_.reduction, 0.5 * goal / largest_[l]);
    for (int k = 0; k < rules_.max_sweeps && any_sweeping(); ++k) {
        sweeps_->multiply(curvature_);
        for (int l = 0; l < W; ++l) {
            given_up_[l] |= sweeping_[l] && !(curvature_[l] > 0.0);
            sweeping_[l] = sweeping_[l] && curvature_[l] > 0.0;
            length_[l] = sweeping_[l] ? r_dot_z_[l] / curvature_[l] : 0.0;
        }
        sweeps_->advance(length_, squared_, sweep_largest_);
        for (int l = 0; l < W; ++l) sweeping_[l] = sweeping_[l] && sweep_largest_[l] > enough[l];
        if (!any_sweeping()) break;
        sweeps_->condition(r_dot_z_next_);
        for (int l = 0; l < W; ++l) {
            turn_[l] = sweeping_[l] ? r_dot_z_next_[l] / r_dot_z_[l] : 0.0;
            r_dot_z_[l] = r_dot_z_next_[l];
        }
        sweeps_->turn(turn_);
    }
    sweeps_->read(correction_.data());
}

/// Residuals of the solution as it stands, in double precision.
template <int W>
void DerivativeLanes<W>::measure() {
    multiply_hessian<W>(graph_, position_.data(), exact_, solution_.data(), product_.data());
    subtract_lanes<W>(size_, right_side_.data(), product_.data(), residual_.data());
    largest_in_lanes<W>(size_, residual_.data(), largest_);
}

template <int W>
void DerivativeLanes<W>::solve() {
    normalize();
    given_up_.fill(false);
    std::fill_n(solution_.data(), solution_.size(), 0.0);
    std::copy_n(right_side_.data(), right_side_.size(), residual_.data());
    std::fill_n(largest_, W, 1.0);
    std::array<double, W> before;
    before.fill(4.0);
    for (int round = 0; round < max_rounds; ++round) {
        for (int l = 0; l < W; ++l) {
            used_[l] = used_[l] && !given_up_[l] && largest_[l] > goal && largest_[l] < 0.5 * before[l];
            sweeping_[l] = used_[l];
            before[l] = largest_[l];
        }
        if (!any_sweeping()) break;
        sweep();
        // Lanes that are done keep what they have.
        for (int l = 0; l < W; ++l) length_[l] = used_[l] ? 1.0 : 0.0;
        add_lanes<W>(size_, length_, correction_.data(), solution_.data());
        measure();
    }
    write_reports();
    scale_lanes<W>(size_, size_of_right_side_, solution_.data());
}

template <int W>
void DerivativeLanes<W>::write_reports() {
    for (int l = 0; l < W; ++l) {
        DerivativeReport& report = report_[l];
        report = DerivativeReport{};
        if (!loaded_[l] || !std::isfinite(size_of_right_side_[l])) continue;
        report.linear_residual = size_of_right_side_[l] > 0.0 ? largest_[l] : 0.0;
        report.positive_definite = !indefinite_[l];
        report.active_set_distance = 1.0;
        report.status =
            !given_up_[l] && report.linear_residual <= accepted ? Status::converged : Status::accuracy_not_reached;
    }
}

template class DerivativeLanes<1>;
template class DerivativeLanes<8>;

}  // namespace toile::prior

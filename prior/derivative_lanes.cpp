#include "prior/derivative_lanes.h"

#include <algorithm>
#include <cmath>

#include "prior/spring_lanes.h"
#include "prior/vector_lanes.h"

namespace toile::prior {
namespace {

constexpr double goal = 1e-12;     // of the residual's largest entry, relative to the right-hand side's
constexpr double accepted = 1e-8;  // what counts as solved

bool all_finite(const double* x, int size) {
    return std::all_of(x, x + size, [](double y) { return std::isfinite(y); });
}

}  // namespace

template <int W>
DerivativeLanes<W>::DerivativeLanes(const SpringGraph& graph, std::unique_ptr<Preconditioner<W>> preconditioner,
                                    int max_sweeps)
    : graph_(graph),
      preconditioner_(std::move(preconditioner)),
      max_sweeps_(max_sweeps),
      size_(3 * graph.vertex_count) {
    for (LaneArray* vector :
         {&predicted_, &position_, &right_side_, &solution_, &residual_, &conditioned_, &search_, &product_})
        *vector = LaneArray(static_cast<size_t>(size_) * W);
    form_ = LaneArray(4 * W * graph.spring.size());
    diagonal_ = LaneArray(2 * W * static_cast<size_t>(size_));
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
    linearize_springs<W>(graph_, position_.data(), exact_, form_.data());
    spring_diagonal<W>(graph_, form_.data(), exact_factor_, diagonal_.data());
    preconditioner_->factor(form_.data(), diagonal_.data(), exact_factor_, lost_pivot_);
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
        exact_factor_[l] = 0.0;
        lost = true;
    }
    if (lost) build();  // these lanes are preconditioned by the projected Hessian; their system stays exact
}

/// Scales each lane's right-hand side to a largest entry of one: no sum over- or underflows.
template <int W>
void DerivativeLanes<W>::normalize() {
    largest_in_lanes<W>(size_, right_side_.data(), size_of_right_side_);
    for (int l = 0; l < W; ++l) {
        const double size = size_of_right_side_[l];
        sweeping_[l] = loaded_[l] && size > 0.0 && std::isfinite(size);
        length_[l] = sweeping_[l] ? 1.0 / size : 0.0;
    }
    scale_lanes<W>(size_, length_, right_side_.data());
}

template <int W>
bool DerivativeLanes<W>::any_sweeping() const {
    return std::any_of(sweeping_.begin(), sweeping_.end(), [](bool sweeping) { return sweeping; });
}

/// Conjugate gradients from zero for the lanes that are `sweeping_`. Lanes that meet negative curvature become
/// `indefinite_`.
template <int W>
void DerivativeLanes<W>::sweep() {
    for (int l = 0; l < W; ++l) length_[l] = sweeping_[l] ? 1.0 : 0.0;
    restart_lanes<W>(size_, length_, right_side_.data(), solution_.data(), residual_.data());
    preconditioner_->solve(residual_.data(), conditioned_.data(), r_dot_z_);
    std::copy_n(conditioned_.data(), conditioned_.size(), search_.data());
    for (int k = 0; k < max_sweeps_ && any_sweeping(); ++k) {
        multiply_springs<W>(graph_, form_.data(), search_.data(), product_.data(), curvature_, squared_);
        for (int l = 0; l < W; ++l) {
            indefinite_[l] |= sweeping_[l] && !(curvature_[l] > 0.0);
            sweeping_[l] = sweeping_[l] && curvature_[l] > 0.0;
            length_[l] = sweeping_[l] ? r_dot_z_[l] / curvature_[l] : 0.0;
        }
        advance_lanes<W>(size_, length_, search_.data(), product_.data(), solution_.data(), residual_.data(), squared_,
                         largest_);
        for (int l = 0; l < W; ++l) sweeping_[l] = sweeping_[l] && largest_[l] > goal;
        if (!any_sweeping()) break;
        preconditioner_->solve(residual_.data(), conditioned_.data(), r_dot_z_next_);
        for (int l = 0; l < W; ++l) {
            turn_[l] = sweeping_[l] ? r_dot_z_next_[l] / r_dot_z_[l] : 0.0;
            r_dot_z_[l] = r_dot_z_next_[l];
        }
        turn_lanes<W>(size_, turn_, conditioned_.data(), search_.data());
    }
}

template <int W>
void DerivativeLanes<W>::solve() {
    normalize();
    const std::array<bool, W> before = indefinite_, used = sweeping_;
    sweep();
    for (int l = 0; l < W; ++l) {
        sweeping_[l] = used[l] && indefinite_[l] && !before[l];
        if (indefinite_[l]) exact_[l] = exact_factor_[l] = 0.0;
    }
    if (any_sweeping()) {
        build();
        sweep();
    }
    measure();
}

/// Reports the residuals that are, not those that were carried along, and gives solutions their size back.
template <int W>
void DerivativeLanes<W>::measure() {
    multiply_springs<W>(graph_, form_.data(), solution_.data(), product_.data(), curvature_, squared_);
    subtract_lanes<W>(size_, right_side_.data(), product_.data(), residual_.data());
    largest_in_lanes<W>(size_, residual_.data(), largest_);
    for (int l = 0; l < W; ++l) {
        DerivativeReport& report = report_[l];
        report = DerivativeReport{};
        if (!loaded_[l] || !std::isfinite(size_of_right_side_[l])) continue;
        report.linear_residual = size_of_right_side_[l] > 0.0 ? largest_[l] : 0.0;
        report.positive_definite = !indefinite_[l];
        report.active_set_distance = 1.0;
        report.status = report.linear_residual <= accepted ? Status::converged : Status::accuracy_not_reached;
    }
    scale_lanes<W>(size_, size_of_right_side_, solution_.data());
}

template class DerivativeLanes<1>;
template class DerivativeLanes<8>;

}  // namespace toile::prior

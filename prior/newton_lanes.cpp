#include "prior/newton_lanes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "prior/vector_lanes.h"

namespace toile::prior {
namespace {

constexpr double sufficient_fall = 1e-4;  // Armijo's constant
constexpr double least_bend = 0.3;
constexpr int max_shortenings = 40;
// Below this share of the energy's terms, a difference of energies is rounding.
constexpr double energy_rounding = 1e-13;

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

template <int W>
NewtonLanes<W>::NewtonLanes(const SpringGraph& graph, const NewtonRules& rules, std::unique_ptr<LinearSweeps<W>> sweeps)
    : graph_(graph),
      rules_(rules),
      sweeps_(std::move(sweeps)),
      size_(3 * graph.vertex_count),
      lane_(std::make_unique<Lane[]>(W)) {
    for (LaneArray* vector : {&predicted_, &position_, &trial_, &gradient_, &trial_gradient_, &direction_})
        *vector = LaneArray(static_cast<size_t>(size_) * W);
    std::fill_n(exact_, W, rules.exact_hessian ? 1.0 : 0.0);
    std::fill_n(exact_factor_, W, 0.0);
    std::fill_n(origin_, 3 * W, 0.0);
}

template <int W>
NewtonLanes<W>::~NewtonLanes() = default;

template <int W>
void NewtonLanes<W>::lap(Stage stage) {
    const double time = now(), share = (time - clock_) / std::max(active_, 1);
    for (int l = 0; l < W; ++l)
        if (lane_[l].number >= 0) lane_[l].seconds[stage] += share;
    clock_ = time;
}

template <int W>
void NewtonLanes<W>::run(const std::function<int(QuasistaticSample&)>& take, const std::function<void(int)>& give_up) {
    give_up_ = &give_up;
    clock_ = now();
    do {
        while (retire() | refill(take)) continue;
        if (active_ == 0) return;
        build_hessian();
        solve_system();
        search_line();
    } while (true);
}

/// Takes finished samples out of their lanes; true if there was one.
template <int W>
bool NewtonLanes<W>::retire() {
    bool any = false;
    for (int l = 0; l < W; ++l) {
        Lane& lane = lane_[l];
        if (lane.number < 0) continue;
        lane.report.residual = std::max(value_.largest[l], value_.lost[l]) / lane.scale;
        const bool converged = lane.report.residual <= rules_.tolerance;
        if (!converged && !lane.stuck && lane.report.iterations < rules_.max_iterations &&
            lane.slow_steps < rules_.max_slow_steps)
            continue;
        lane.report.status = converged ? Status::converged : Status::accuracy_not_reached;
        finish(lane, l);
        any = true;
    }
    return any;
}

template <int W>
bool NewtonLanes<W>::refill(const std::function<int(QuasistaticSample&)>& take) {
    bool fresh[W] = {};
    int count = 0;
    for (int l = 0; l < W; ++l) {
        while (lane_[l].number < 0) {
            Lane next;
            next.number = take(next.sample);
            if (next.number < 0) break;
            lane_[l] = next;
            if (!load(l)) {
                lane_[l].number = -1;
                continue;
            }
            lane_[l].report = *next.sample.report;
            fresh[l] = true;
            ++count;
            ++active_;
        }
    }
    if (count == 0) return false;
    evaluate_springs<W>(graph_, position_.data(), predicted_.data(), gradient_.data(), value_);
    bool moved = false;
    for (int l = 0; l < W; ++l) {
        if (!fresh[l]) continue;
        lane_[l].scale = std::max(value_.largest[l], graph_.reference_force);
        if (!(lane_[l].scale > 0.0)) lane_[l].scale = 1.0;
        moved |= start(l);
    }
    if (moved) evaluate_springs<W>(graph_, position_.data(), predicted_.data(), gradient_.data(), value_);
    lap(assembly);
    return true;
}

template <int W>
void NewtonLanes<W>::build_hessian() {
    sweeps_->linearize(position_.data(), exact_, exact_factor_);
    lap(assembly);
    sweeps_->factor(exact_factor_, lost_pivot_);
    lap(factor);
}

template <int W>
bool NewtonLanes<W>::any_sweeping() const {
    return std::any_of(lane_.get(), lane_.get() + W, [](const Lane& lane) { return lane.sweeping; });
}

/// r = g, d = 0, q = z = P r; and how far each lane wants to go.
template <int W>
void NewtonLanes<W>::begin_sweeps() {
    sweeps_->begin(gradient_.data(), r_dot_z_, residual_squared_, residual_largest_);
    lap(preconditioning);
    for (int l = 0; l < W; ++l) {
        Lane& lane = lane_[l];
        lane.sweeping = lane.number >= 0;
        if (!lane.sweeping) continue;
        lane.right_side_norm = std::sqrt(residual_squared_[l]);
        // Superlinear: as much accuracy as the last step gained.
        const double gained = lane.previous_largest > 0.0 ? value_.largest[l] / lane.previous_largest : 1.0;
        const double goal = 0.3 * rules_.tolerance * lane.scale / value_.largest[l];
        lane.forcing = std::max(std::min(rules_.loosest_forcing, gained), goal);
        lane.previous_largest = value_.largest[l];
        lane.search_norm = r_dot_z_[l];
    }
}

/// The step along `search_` for each lane; negative curvature ends a lane's sweeps.
template <int W>
void NewtonLanes<W>::accept_curvature() {
    for (int l = 0; l < W; ++l) {
        Lane& lane = lane_[l];
        length_[l] = 0.0;
        if (!lane.sweeping) continue;
        ++lane.report.sweeps;
        // q·Mq, M being the preconditioner, by the method's own recurrence: what the curvature should be.
        const double usual = lane.search_norm;
        const bool stop = !(curvature_[l] > 0.0) || !(r_dot_z_[l] > 0.0);
        const double bend = stop ? std::max(std::abs(curvature_[l]), least_bend * usual) : curvature_[l];
        length_[l] = r_dot_z_[l] > 0.0 && bend > 0.0 ? r_dot_z_[l] / bend : 0.0;
        lane.sweeping = !stop;
    }
}

template <int W>
void NewtonLanes<W>::solve_system() {
    begin_sweeps();
    for (int k = 0; any_sweeping(); ++k) {
        sweeps_->multiply(curvature_);
        accept_curvature();
        sweeps_->advance(length_, residual_squared_, residual_largest_);
        for (int l = 0; l < W; ++l) {
            Lane& lane = lane_[l];
            if (!lane.sweeping) continue;
            lane.sweeping = std::sqrt(residual_squared_[l]) > lane.forcing * lane.right_side_norm;
            if (lane.sweeping && k + 1 >= rules_.max_sweeps) {
                lane.sweeping = false;
                ++lane.slow_steps;
            }
        }
        lap(sweep);
        if (!any_sweeping()) break;
        sweeps_->condition(r_dot_z_next_);
        for (int l = 0; l < W; ++l) {
            turn_[l] = lane_[l].sweeping ? r_dot_z_next_[l] / r_dot_z_[l] : 0.0;
            r_dot_z_[l] = r_dot_z_next_[l];
            lane_[l].search_norm = r_dot_z_[l] + turn_[l] * turn_[l] * lane_[l].search_norm;
        }
        sweeps_->turn(turn_);
        lap(preconditioning);
    }
    sweeps_->read(direction_.data());
}

/// Whether the trial will do; if not, the step is made shorter.
template <int W>
bool NewtonLanes<W>::accept_or_shorten(Lane& lane, int l) {
    const double s = length_[l], fall = value_.energy[l] - trial_value_.energy[l];
    const double rounding = energy_rounding * (value_.energy_size[l] + trial_value_.energy_size[l]);
    const bool falls = fall >= sufficient_fall * s * slope_[l] && slope_[l] > 0.0;
    // Where the energies' difference is rounding, the gradient tells.
    const bool flatter = std::abs(fall) <= rounding && trial_value_.largest[l] < value_.largest[l];
    if (falls || flatter) return true;
    if (++lane.shortenings > max_shortenings || !(slope_[l] > 0.0)) {
        lane.stuck = true;
        length_[l] = 0.0;
        return false;
    }
    // The minimum of the parabola through both energies and the slope.
    const double parabola = 0.5 * slope_[l] * s * s / (s * slope_[l] - fall);
    length_[l] = std::isfinite(parabola) ? std::clamp(parabola, 0.1 * s, 0.5 * s) : 0.1 * s;
    return false;
}

template <int W>
void NewtonLanes<W>::search_line() {
    for (int l = 0; l < W; ++l) {
        Lane& lane = lane_[l];
        lane.searching = lane.number >= 0;
        lane.shortenings = 0;
        length_[l] = lane.searching ? 1.0 : 0.0;
        lane.report.iterations += lane.searching;
    }
    for (bool again = true; again;) {
        step_lanes<W>(size_, length_, position_.data(), direction_.data(), gradient_.data(), origin_, trial_.data(),
                      slope_);
        evaluate_springs<W>(graph_, trial_.data(), predicted_.data(), trial_gradient_.data(), trial_value_);
        again = false;
        for (int l = 0; l < W; ++l) {
            Lane& lane = lane_[l];
            if (!lane.searching) continue;
            const bool accepted = accept_or_shorten(lane, l);
            lane.searching = !accepted && !lane.stuck;
            again |= !accepted;  // also where stuck: back to where it was
        }
    }
    std::swap(position_, trial_);
    std::swap(gradient_, trial_gradient_);
    std::swap(value_, trial_value_);
    lap(assembly);
}

template class NewtonLanes<1>;
template class NewtonLanes<8>;

}  // namespace toile::prior

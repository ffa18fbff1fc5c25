#include "prior/newton_lanes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

#include "prior/vector_lanes.h"

namespace toile::prior {
namespace {

constexpr double shake_size = 1e-3;       // of an edge
constexpr double flatness = 1e-4;         // thickness of a prediction that counts as a plane, of an edge
constexpr double sufficient_fall = 1e-4;  // Armijo's constant
constexpr double least_bend = 0.3;
constexpr int max_shortenings = 40;
// Below this share of the energy's terms, a difference of energies is rounding.
constexpr double energy_rounding = 1e-13;

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// From -1 to 1, the same for the same number always (splitmix64).
double fixed_noise(std::uint64_t number) {
    std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace

template <int W>
struct NewtonLanes<W>::Lane {
    int number = -1;  // of the sample, or -1
    QuasistaticSample sample;
    Report report;
    double seconds[stages] = {};
    double scale = 1;             // the residual's denominator
    double right_side_norm = 0;   // 2-norm of the system's right-hand side, in the units of the sweeps
    double previous_largest = 0;  // entry of the gradient, a step before; 0 at first
    int slow_steps = 0;
    bool stuck = false;     // no step lowers the energy
    bool sweeping = false;  // in conjugate gradients
    bool searching = false;
    int shortenings = 0;
    double forcing = 0;
    double search_norm = 0;  // q·Mq of the search direction, M being the preconditioner
};

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

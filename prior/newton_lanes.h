#pragma once

#include <functional>
#include <memory>

#include "cloth/lane_array.h"
#include "prior/linear_sweeps.h"
#include "prior/quasistatic.h"
#include "prior/spring_graph.h"
#include "prior/spring_lanes.h"

namespace toile::prior {

/// How a Newton solver works. The defaults are those of `Method::fast`.
struct NewtonRules {
    double tolerance = 1e-6;
    int max_iterations = 500;
    bool exact_hessian = true;      ///< else every spring's Hessian is projected
    double loosest_forcing = 0.25;  ///< conjugate gradients stop at this share of the gradient, or earlier near the end
    int max_sweeps = 250;           ///< conjugate gradients in one Newton step
    int max_slow_steps = 2;         ///< so many steps may need all of them before the sample is given up as hard
};

/// One sample of a batch: where it comes from and goes to.
struct QuasistaticSample {
    const double* predicted = nullptr;  ///< `[V x 3]`
    const double* start = nullptr;      ///< `[V x 3]`, or null to start from the prediction
    double* position = nullptr;         ///< `[V x 3]` out
    Report* report = nullptr;
};

/// Newton's method with conjugate gradients and line search on the quasistatic energy, for W samples side by side: each
/// lane has its own step, accuracy and fate, and takes the next sample when it is done with one. Conjugate gradients
/// run on the exact Hessian and stop at a direction of negative curvature (Steihaug); steps shrink until the energy
/// falls.
template <int W>
class NewtonLanes {
  public:
    NewtonLanes(const SpringGraph& graph, const NewtonRules& rules, std::unique_ptr<LinearSweeps<W>> sweeps);
    ~NewtonLanes();

    /// Works off samples: `take` gives the next and returns its number, or -1 when there are none. `give_up(number)` is
    /// told of samples that did not reach the tolerance.
    void run(const std::function<int(QuasistaticSample&)>& take, const std::function<void(int)>& give_up);

  private:
    enum Stage { sweep, assembly, factor, preconditioning, stages };
    struct Lane {
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

    bool retire();
    bool refill(const std::function<int(QuasistaticSample&)>& take);
    bool load(int lane);
    bool start(int lane);
    bool is_flat(int lane) const;
    void finish(Lane& lane, int l);
    void build_hessian();
    void begin_sweeps();
    void solve_system();
    void accept_curvature();
    void search_line();
    bool accept_or_shorten(Lane& lane, int l);
    void lap(Stage stage);
    bool any_sweeping() const;

    const SpringGraph& graph_;
    NewtonRules rules_;
    std::unique_ptr<LinearSweeps<W>> sweeps_;
    int size_;  // 3V
    const std::function<void(int)>* give_up_ = nullptr;
    LaneArray predicted_, position_, trial_, gradient_, trial_gradient_, direction_;
    SpringValue<W> value_, trial_value_;
    alignas(64) double exact_[W], exact_factor_[W], lost_pivot_[W], origin_[3 * W], length_[W], turn_[W], curvature_[W],
        residual_squared_[W], residual_largest_[W], r_dot_z_[W], r_dot_z_next_[W], slope_[W];
    std::unique_ptr<Lane[]> lane_;
    int active_ = 0;
    double clock_ = 0;
};

extern template class NewtonLanes<1>;
extern template class NewtonLanes<8>;

}  // namespace toile::prior

#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/stability_cases.h"
#include "evaluate/stress.h"
#include "generate/progress.h"
#include "simulate/drape.h"

namespace toile::evaluate {

/// How often and how far a drape's energy went up on its way to rest, the solids standing still. Friction's springs are
/// not counted as the cloth's energy: they are made anew where a contact's load changes, with the same force and
/// another stiffness. What they hold before a step the step may give back to the cloth; what rises by more came from
/// nowhere.
class EnergyTrace {
  public:
    /// Energy is told in metres: how far it would lift the garment, of this weight [N].
    explicit EnergyTrace(double weight = 1.0) : weight_(weight) {}

    /// Next energy. NaN: not measured.
    void add(const simulate::EnergySample& sample);

    bool measured() const { return measured_; }
    int steps() const { return steps_; }  ///< between two energies of one try
    int rises() const { return rises_; }  ///< steps that raised it by more than a micrometre, which is left to rounding
    double largest_rise() const;          ///< of one step [m], without what springs held; NaN: nothing was measured

  private:
    double weight_, last_ = 0, held_ = 0, rise_ = 0;
    int steps_ = 0, rises_ = 0;
    bool measured_ = false;
};

/// What became of one case with one solver: a drape, or a sample that a prior projected.
struct StabilityOutcome {
    std::string group, name, solver;
    std::string status;    ///< a certificate's reason, why nothing was draped, or what a prior says of its accuracy
    bool rests = false;    ///< accepted by the gate in every pose
    bool finite = false;   ///< every position
    bool falling = false;  ///< energy never rose; also where it was not measured
    double energy_rise = std::numeric_limits<double>::quiet_NaN();  ///< largest of one step [m], see EnergyTrace
    simulate::Certificate certificate;                              ///< of the last drape; seconds: all
    int iterations = 0, vertices = 0;
    std::optional<StressOutcome> prior;  ///< of a sample that a prior projected; what is said of drapes above is empty
    std::string replay;                  ///< file that runs it again, within the folder of results; empty: none kept
    std::string command;                 ///< that runs it again, from that folder

    /// A drape: at rest within the gate, finite, energy never rose. A sample: converged, finite, the residual computed
    /// again within the tolerance, and the derivative, where it was tried, accurate to 1e-9.
    bool passed() const { return prior ? prior->met() && prior->derivative_met() : rests && finite && falling; }
    /// A prior that says it converged, or that its derivative is accurate, and is wrong: never excused.
    bool false_claim() const { return prior && (prior->false_claim() || prior->false_derivative()); }
    bool available() const { return status.rfind("not available", 0) != 0; }
    double residual() const { return prior ? prior->residual : certificate.residual_force; }
};

/// The problems that priors are tried on: drawn at random (evaluate/stress_problem.h), each by its number alone. Quick:
/// the first 40, as far as they have no more than 300 vertices. The paper's routes are spared those of more than 2,000.
struct PriorSuite {
    StressDraw draw;
    int problems = 400;
};

/// What a case may take; what is absent is the scene's own.
struct StabilityBudget {
    std::optional<int> iterations;  ///< of a try to come to rest, 1 to 1000000
    std::optional<int> tries;       ///< after the first, see simulate/ladder.h, 0 to 3
};

struct StabilityOptions {
    std::vector<std::string> solver = {"implicit"};  ///< of `solver_names` and `prior_names`
    PriorSuite priors;                               ///< the problems that priors are given
    int jobs = 1;                                    ///< of those, side by side
    std::string filter;                              ///< cases whose name holds this text; empty: all
    bool quick = false;                              ///< the quick ones alone
    bool resume = false;                             ///< keep the outcomes that the folder has, and run what is missing
    std::vector<StabilityOutcome> known;  ///< outcomes that need not be found again; they are part of the result
    StabilityBudget budget;
    generate::ProgressCallback progress;
    std::function<void(const std::vector<StabilityOutcome>&)> store;  ///< called now and then with all so far
    std::string folder;  ///< of results, for what runs failing cases again (evaluate/stability_replay.h); empty: none
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between cases
};

/// The priors, in the order they are shown; each is tried by its own route and by the paper's, which then are solvers
/// of their own: "quasistatic/fast".
const std::vector<std::string>& prior_names();

/// The solvers that simulations can be made with, in the order they are shown.
const std::vector<std::string>& solver_names();

/// Why a solver cannot be had, as it says itself; empty where it can.
std::string missing_solver(const std::string& solver);

/// A case with a solver and its budget, as it is draped.
StabilityScene case_scene(const StabilityCase& one, const std::string& solver, const StabilityBudget& budget);

/// Drapes a scene, tells `outcome`, and returns the last drape. Throws what the solver throws.
simulate::DrapeResult drape_case(const StabilityScene& scene, StabilityOutcome& outcome);

/// Drapes one case. Never throws for what a solver makes of it. Where it fails, what runs it again is kept in `folder`,
/// unless that is empty.
StabilityOutcome run_stability_case(const StabilityCase& one, const std::string& solver,
                                    const StabilityBudget& budget = {}, const std::string& folder = {});

/// All cases asked for and what was known, by solver, in the suite's order: drapes one after the other so that times
/// can be compared; samples' times are of their own processor. Throws Error where the filter leaves nothing.
std::vector<StabilityOutcome> run_stability(const StabilityOptions& options);

}  // namespace toile::evaluate

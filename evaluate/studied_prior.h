#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prior/inextensibility.h"
#include "prior/quasistatic.h"

namespace toile::evaluate {

/// One method of a prior at one tolerance, whichever it is: the priors as the studies see them.
class StudiedPrior {
  public:
    virtual ~StudiedPrior() = default;

    /// Solutions of N samples, contiguous.
    struct Solved {
        std::vector<double> position;    ///< `[N x V x 3]`
        std::vector<double> multiplier;  ///< `[N x E]`, inextensibility alone
        std::vector<prior::Report> report;
    };
    struct Gradient {
        std::vector<double> predicted;  ///< `[N x V x 3]` ∂E/∂r̂
        std::vector<prior::DerivativeReport> report;
    };

    virtual void project(std::span<const double> predicted, Solved& solved) = 0;
    /// From an earlier solution on, to this object's tolerance.
    virtual void polish(std::span<const double> predicted, Solved& solved) = 0;
    virtual void backward(std::span<const double> predicted, const Solved& solved,
                          std::span<const double> loss_gradient, Gradient& gradient) = 0;
    /// The contract's residual of one sample, computed again from positions and multipliers.
    virtual double residual(std::span<const double> predicted, const Solved& solved) const = 0;
};

/// A way to compute a prior.
struct SolutionMethod {
    std::string prior;         ///< "inextensibility", "quasistatic"
    std::string method;        ///< "interior_point", "cone", "fast", "newton_cg"
    bool one_solution = true;  ///< false: not convex, a method may come to rest in another minimum
    std::function<std::unique_ptr<StudiedPrior>(const prior::RestState&, double tolerance, int threads)> make;

    std::string name() const { return prior + "/" + method; }
};
/// Every method in prior/, those of one prior one after the other, the default method first. No stretch allowed;
/// default fabric and μ.
std::vector<SolutionMethod> solution_methods();

/// What tells one prior from the other.
inline constexpr double reference_tolerance = 1e-10;

/// The solution that others are compared with, of one sample.
struct Reference {
    StudiedPrior::Solved solved;
    double residual = 0;     ///< computed again
    bool certified = false;  ///< the solver says converged, and the residual computed again is within its tolerance
    std::string method;
};
/// Solves each sample to `reference_tolerance` with the first of `methods` that gets there. `predicted` `[N]` of
/// `[V x 3]`.
std::vector<Reference> certified_references(const std::vector<SolutionMethod>& methods, const prior::RestState& rest,
                                            const std::vector<std::vector<double>>& predicted);

/// Where a solution that stopped early was going: solved on to `reference_tolerance`, it is further than a thousandth
/// of the mean edge from the reference, and so in another minimum of the energy. False for what cannot be solved on.
class MinimumCheck {
  public:
    MinimumCheck(const SolutionMethod& method, const prior::RestState& rest);
    bool other_minimum(std::span<const double> predicted, const StudiedPrior::Solved& solved,
                       const Reference& reference);

  private:
    bool needed_;
    double least_distance_;  // [m]
    std::unique_ptr<StudiedPrior> prior_;
};

/// Distances of the vertices of two clothes `[V x 3]` [m].
struct ClothDistance {
    double rms = 0, largest = 0;
};
ClothDistance cloth_distance(std::span<const double> a, std::span<const double> b);

}  // namespace toile::evaluate

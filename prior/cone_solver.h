#pragma once

#include <memory>
#include <span>

#include "prior/inextensibility.h"

namespace toile::prior {

/// `method = "cone"` of the inextensibility prior: the paper's own route, one sample at a time. Forward by an
/// interior-point method on the cone program (`cone_program.h`, `cone_interior_point.h`), then a few Newton steps on
/// the taut edges it found (`cone_polish.h`); backward by the symmetrised cone system (`cone_derivative.h`). It is made
/// to be accurate and hard to upset, as what the fast method is tested against.
class ConeSolver {
  public:
    class Workspace;

    explicit ConeSolver(const InextensibilityModel& model);

    void set_edge_max_length(const Eigen::VectorXd& edge_max_length) { model_.edge_max_length = edge_max_length; }

    /// Projects one sample: `predicted` `[V x 3]` to `position` `[V x 3]` and `multiplier` `[E]`. A prediction with NaN
    /// or infinity is rejected with NaN in both.
    Report project(std::span<const double> predicted, std::span<double> position, std::span<double> multiplier,
                   const InextensibilityOptions& options, Workspace& workspace) const;

    /// The same for a caller without a workspace: analyses the system anew.
    Report project(std::span<const double> predicted, std::span<double> position, std::span<double> multiplier,
                   const InextensibilityOptions& options) const;

    /// ∂L/∂r* `[V x 3]` to ∂L/∂r̂ `[V x 3]` and ∂L/∂l_e^max `[E]`, at a solution that `project` or another method gave.
    /// Of a rejected one, NaN.
    DerivativeReport backward(std::span<const double> position, std::span<const double> multiplier,
                              std::span<const double> loss_gradient, std::span<double> predicted_gradient,
                              std::span<double> edge_max_length_gradient) const;

    /// Changes of r̂ `[V x 3]` and of the limits `[E]` (or empty) to that of r* `[V x 3]`.
    DerivativeReport tangent(std::span<const double> position, std::span<const double> multiplier,
                             std::span<const double> predicted_change, std::span<const double> edge_max_length_change,
                             std::span<double> position_change) const;

  private:
    InextensibilityModel model_;
};

/// Buffers and the symbolic factorisation for one caller.
class ConeSolver::Workspace {
  public:
    explicit Workspace(const ConeSolver& solver);
    ~Workspace();
    Workspace(Workspace&&) noexcept;

  private:
    friend class ConeSolver;
    struct Buffers;
    std::unique_ptr<Buffers> buffers_;
};

}  // namespace toile::prior

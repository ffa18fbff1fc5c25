#pragma once

#include <memory>
#include <span>
#include <vector>

#include "prior/report.h"
#include "prior/rest_state.h"

namespace toile::prior {

/// The convex program of the paper's Section 3 as data: a vertex may move from its prediction at a cost, no edge may be
/// longer than its limit.
///
///     r* = argmin_r  Σ_i ½ k_i |r̂_i − r_i|²    subject to   l_e(r) <= l_e^max
struct InextensibilityModel {
    int vertex_count = 0;
    Edges edge;                        ///< `[E x 2]`
    Eigen::VectorXd edge_max_length;   ///< `[E]` l_e^max [m], positive
    Eigen::VectorXd target_stiffness;  ///< `[V]` k_i, positive; a common factor changes nothing but the multipliers

    /// l_e^max = (1 + stretch_limit) times the rest length, k_i = vertex mass over the mean vertex mass.
    static InextensibilityModel from(const RestState& rest, double stretch_limit);
};

struct InextensibilityOptions {
    enum class Method {
        interior_point,  ///< first-order sweeps on a constant V x V matrix, then a primal-dual interior point
        cone  ///< the paper's own route: its second-order cone program by an interior-point method, one sample at a
              ///< time
    };
    Method method = Method::interior_point;
    double tolerance = 1e-6;   ///< of `Report::residual`; in [1e-10, 1e-1]
    int max_iterations = 200;  ///< second-order steps a sample may take; at least 1

    /// Throws Error naming field, value and bound.
    void validate() const;
};

/// Solutions of a batch, contiguous by sample. To warm-start, pass an earlier solution of the same samples.
struct InextensibilitySolution {
    std::vector<double> position;    ///< `[N x V x 3]` r* [m]
    std::vector<double> multiplier;  ///< `[N x E]` λ_e >= 0 [k_i times m]
    std::vector<Report> report;      ///< `[N]`
};

/// Of a loss L(r*): what `backward` gives.
struct InextensibilityGradient {
    std::vector<double> predicted;        ///< `[N x V x 3]` ∂L/∂r̂
    std::vector<double> edge_max_length;  ///< `[N x E]` ∂L/∂l_e^max (for ∂L/∂ε, sum it times the rest lengths)
    std::vector<DerivativeReport> report;  ///< `[N]`
};

/// What `tangent` gives: the change of r* along a change of the inputs.
struct InextensibilityTangent {
    std::vector<double> position;          ///< `[N x V x 3]`
    std::vector<DerivativeReport> report;  ///< `[N]`
};

/// The inextensibility prior for one mesh: built once, then any number of samples, from any number of threads, each
/// with its own `Workspace`.
///
///     prior::Inextensibility prior(prior::InextensibilityModel::from(prior::rest_state(mesh), 0.0));
///     prior::Inextensibility::Workspace workspace(prior);
///     prior::InextensibilitySolution solution;
///     prior.project(predicted, solution, workspace);                 // predicted: [N x V x 3]
///     prior.backward(solution, loss_gradient, gradient, workspace);  // ∂L/∂r* -> ∂L/∂r̂
///
/// Where a batch holds more than one sample, eight go side by side through the same sparse code, and a sample's result
/// does not depend on the others or on their order. One sample alone takes a code path of its own: the same problem to
/// the same tolerance, with other last digits.
class Inextensibility {
  public:
    class Workspace;

    /// Throws Error for a model or options that make no sense.
    explicit Inextensibility(InextensibilityModel model, const InextensibilityOptions& options = {});
    ~Inextensibility();
    Inextensibility(Inextensibility&&) noexcept;

    const InextensibilityModel& model() const;
    const InextensibilityOptions& options() const;
    /// New limits `[E]` for the same mesh (a learnable ε): keeps all symbolic work. Not while other threads use it.
    void set_edge_max_length(const Eigen::VectorXd& edge_max_length);

    /// Projects `predicted` `[N x V x 3]`. With `warm_start`, `solution` holds an earlier solution of these samples
    /// (one that does not fit is an Error); otherwise what it holds is replaced.
    void project(std::span<const double> predicted, InextensibilitySolution& solution, Workspace& workspace,
                 bool warm_start = false) const;

    /// Vector-Jacobian product: from ∂L/∂r* `[N x V x 3]` to the derivatives by r̂ and by the limits (method.md, Section
    /// 2; paper, Appendix A). Where the taut edges are degenerate, the multipliers' change is of minimal norm; weakly
    /// active edges count as free, and are reported. A sample that was rejected gets NaN.
    void backward(const InextensibilitySolution& solution, std::span<const double> loss_gradient,
                  InextensibilityGradient& gradient, Workspace& workspace) const;

    /// Jacobian-vector product: from changes of r̂ `[N x V x 3]` and of the limits `[N x E]` (or empty) to that of r*.
    void tangent(const InextensibilitySolution& solution, std::span<const double> predicted_change,
                 std::span<const double> edge_max_length_change, InextensibilityTangent& tangent,
                 Workspace& workspace) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The buffers of one caller: sized at the first call of each kind, reused afterwards. `threads` share a batch's work.
class Inextensibility::Workspace {
  public:
    explicit Workspace(const Inextensibility& prior, int threads = 1);
    ~Workspace();
    Workspace(Workspace&&) noexcept;

  private:
    friend class Inextensibility;
    struct Buffers;
    std::unique_ptr<Buffers> buffers_;
};

/// One sample, once: builds the class and throws it away.
InextensibilitySolution project_inextensible(const ClothMesh& mesh, const Positions& predicted,
                                             double stretch_limit = 0.0, const InextensibilityOptions& options = {});

/// The residual that the contract defines, of positions `[V x 3]` and multipliers `[E]` for a prediction.
double inextensibility_residual(const InextensibilityModel& model, std::span<const double> predicted,
                                std::span<const double> position, std::span<const double> multiplier);

}  // namespace toile::prior

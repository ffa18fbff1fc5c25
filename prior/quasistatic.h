#pragma once

#include <memory>
#include <span>
#include <vector>

#include "prior/report.h"
#include "prior/rest_state.h"

namespace toile::prior {

/// A fabric's moduli as the quasistatic prior takes them.
/// TODO(default values and their sources)
struct QuasistaticStiffness {
    double stretch = 1.0;  ///< edge springs
    double bending = 1.0;  ///< bending springs
    double axial = 1.0;    ///< axial springs
};

/// The spring model of the paper's Section 4 as data.
///
///     E_edge    = Σ ½ k^L_e (l_e(r) − l̄_e)²                                over mesh edges
///     E_bending = Σ ½ k^B_e (l_e(r) − l̄_e)²                                over the opposite vertices of each triangle
///     pair E_axial   = Σ ½ k^A_e |(1−u) r_a + u r_b − (1−v) r_c − v r_d|²       shared edge (a,b) to bending edge
///     (c,d) E_Z       = Σ ½ μ_i k^Z_i |r̂_i − r_i|²                               zero-length springs to the prediction
struct QuasistaticModel {
    int vertex_count = 0;
    Edges edge_spring;                                                       ///< `[E x 2]`
    Eigen::VectorXd edge_stiffness;                                          ///< `[E]` [N/m]
    Eigen::VectorXd edge_rest_length;                                        ///< `[E]` [m]
    Edges bending_spring;                                                    ///< `[B x 2]`
    Eigen::VectorXd bending_stiffness;                                       ///< `[B]` [N/m]
    Eigen::VectorXd bending_rest_length;                                     ///< `[B]` [m]
    Hinges axial_spring;                                                     ///< `[A x 4]` a, b, c, d
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> axial_weight;  ///< `[A x 2]` u, v
    Eigen::VectorXd axial_stiffness;                                         ///< `[A]` [N/m]
    Eigen::VectorXd target_stiffness;                                        ///< `[V]` μ_i k^Z_i [N/m], positive
    Eigen::VectorXd target_unit;  ///< `[V]` k^Z_i [N/m]: the target stiffness at μ = 1

    static QuasistaticModel from(const RestState& rest, const QuasistaticStiffness& stiffness, double mu);
};

struct QuasistaticOptions {
    enum class Method {
        fast,      ///< the default: TODO
        newton_cg  ///< the paper's route: projected Newton, each system by conjugate gradients
    };
    Method method = Method::fast;
    double tolerance = 1e-6;   ///< of `Report::residual`; in [1e-12, 1e-1]
    int max_iterations = 500;  ///< second-order steps a sample may take; at least 1

    void validate() const;
};

struct QuasistaticSolution {
    std::vector<double> position;  ///< `[N x V x 3]` r* [m]
    std::vector<Report> report;    ///< `[N]`
};

/// Of a loss L(r*): what `backward` gives.
struct QuasistaticGradient {
    std::vector<double> predicted;         ///< `[N x V x 3]` ∂L/∂r̂
    std::vector<double> mu_vertex;         ///< `[N x V]` ∂L/∂μ_i
    std::vector<double> mu;                ///< `[N]` ∂L/∂μ = Σ_i ∂L/∂μ_i
    std::vector<double> stretch;           ///< `[N]` derivative by a common factor of all edge stiffnesses, at 1
    std::vector<double> bending;           ///< `[N]` the same for bending stiffnesses
    std::vector<double> axial;             ///< `[N]` the same for axial stiffnesses
    std::vector<DerivativeReport> report;  ///< `[N]`
};

/// A change of the inputs of one batch; an empty member is no change.
struct QuasistaticChange {
    std::span<const double> predicted;                ///< `[N x V x 3]`
    std::span<const double> mu_vertex;                ///< `[N x V]`
    std::span<const double> stretch, bending, axial;  ///< `[N]` change of the common factors
};

struct QuasistaticTangent {
    std::vector<double> position;  ///< `[N x V x 3]`
    std::vector<DerivativeReport> report;
};

/// The quasistatic prior for one mesh: built once, then any number of samples, from any number of threads, each with
/// its own `Workspace`. Batches and single samples as in `Inextensibility`.
class Quasistatic {
  public:
    class Workspace;

    explicit Quasistatic(QuasistaticModel model, const QuasistaticOptions& options = {});
    ~Quasistatic();
    Quasistatic(Quasistatic&&) noexcept;

    const QuasistaticModel& model() const;
    const QuasistaticOptions& options() const;
    /// μ_i `[V]` for the same mesh: keeps all symbolic work. Not while other threads use it.
    void set_mu(const Eigen::VectorXd& mu_vertex);

    void project(std::span<const double> predicted, QuasistaticSolution& solution, Workspace& workspace,
                 bool warm_start = false) const;
    /// Vector-Jacobian product with the exact Hessian at r* (method.md, Section 3).
    void backward(std::span<const double> predicted, const QuasistaticSolution& solution,
                  std::span<const double> loss_gradient, QuasistaticGradient& gradient, Workspace& workspace) const;
    /// Jacobian-vector product.
    void tangent(std::span<const double> predicted, const QuasistaticSolution& solution,
                 const QuasistaticChange& change, QuasistaticTangent& tangent, Workspace& workspace) const;

  private:
    struct Impl;
    std::unique_ptr<const Impl> impl_;
};

class Quasistatic::Workspace {
  public:
    explicit Workspace(const Quasistatic& prior, int threads = 1);
    ~Workspace();
    Workspace(Workspace&&) noexcept;

  private:
    friend class Quasistatic;
    struct Buffers;
    std::unique_ptr<Buffers> buffers_;
};

/// One sample, once.
QuasistaticSolution project_quasistatic(const ClothMesh& mesh, const Positions& predicted, double mu = 0.1,
                                        const QuasistaticStiffness& stiffness = {},
                                        const QuasistaticOptions& options = {});

/// |∇E(r)|_∞ / max(|∇E(r̂)|_∞, mean_e k^L_e l̄_e), the residual that the contract defines.
double quasistatic_residual(const QuasistaticModel& model, std::span<const double> predicted,
                            std::span<const double> position);

}  // namespace toile::prior

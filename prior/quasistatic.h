#pragma once

#include <memory>
#include <span>
#include <vector>

#include "prior/report.h"
#include "prior/rest_state.h"

namespace toile::prior {

/// A fabric's moduli as the quasistatic prior takes them, all in N/m: each is the stiffness of a spring in a mesh of
/// regular triangles, and a spring's own is that times a number without unit (`QuasistaticModel::from`). The defaults
/// are a heavy denim on a garment mesh with edges of 17 mm (a T-shirt of 3,000 vertices):
///
/// - stretch: a lattice of springs with the modulus E has the shear modulus 3/8 E. 400 N/m gives 150 N/m, within the 84
///   to 190 N/m measured on denims (1.5 to 3.4 gf/cm/degree on the KES-F; Journal of Textiles 2016, 4614168, Table 5).
///   The stiffer warp and weft are left out.
/// - axial: the springs bend like a plate of rigidity B where axial = 55 B / L², L = 29 mm being the length of a
/// bending
///   spring. 12 N/m gives 2e-4 N m: cloth of 0.47 kg/m² with a bending length of 3.5 cm in the cantilever test of ASTM
///   D1388 (B = w g c³).
/// - bending: the same number.
///
/// With them, μ around 0.1 brings smooth cloth with noise of 1 to 10 mm closest to the truth; the error rises towards
/// 1e-4 (the cloth drifts and unbends) and 1e3 (the noise stays).
/// Cloth that hangs, stretched by its weight, wants stiffer target springs: on the drapes of configs/quick.toml with
/// noise of 2 mm, μ around 1 is best.
struct QuasistaticStiffness {
    double stretch = 400.0;  ///< edge springs [N/m], positive
    double bending = 12.0;   ///< bending springs [N/m], not negative
    double axial = 12.0;     ///< axial springs [N/m], not negative
};

/// The spring model of the paper's Section 5 as data (method.md, Section 3).
///
///     E_edge    = Σ ½ k^L_e (l_e(r) − l̄_e)²                             over mesh edges
///     E_bending = Σ ½ k^B_e (l_e(r) − l̄_e)²                             over the opposite vertices of triangle pairs
///     E_axial   = Σ ½ k^A_e |(1−u) r_a + u r_b − (1−v) r_c − v r_d|²    shared edge (a,b) to bending edge (c,d)
///     E_Z       = Σ ½ μ_i k^Z_i |r̂_i − r_i|²                            zero-length springs to the prediction
struct QuasistaticModel {
    int vertex_count = 0;
    Edges edge_spring;                                                       ///< `[E x 2]`
    Eigen::VectorXd edge_stiffness;                                          ///< `[E]` [N/m], not negative
    Eigen::VectorXd edge_rest_length;                                        ///< `[E]` [m], not negative
    Edges bending_spring;                                                    ///< `[B x 2]`
    Eigen::VectorXd bending_stiffness;                                       ///< `[B]` [N/m], not negative
    Eigen::VectorXd bending_rest_length;                                     ///< `[B]` [m], not negative
    Hinges axial_spring;                                                     ///< `[A x 4]` a, b, c, d
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> axial_weight;  ///< `[A x 2]` u, v
    Eigen::VectorXd axial_stiffness;                                         ///< `[A]` [N/m], not negative
    Eigen::VectorXd target_stiffness;                                        ///< `[V]` μ_i k^Z_i [N/m], positive
    Eigen::VectorXd target_unit;  ///< `[V]` k^Z_i [N/m], positive: the target stiffness at μ = 1

    /// k^L = (√3/2) stretch, half of it for an edge in no triangle pair; k^B = bending; k^A = axial / |w|², w being the
    /// spring's four weights (1 where it joins two midpoints); k^Z_i = 200 N/m times vertex mass over mean vertex mass.
    /// No length enters, so a solution scales with its mesh: metres or millimetres, heavy or light cloth.
    /// Throws Error for moduli or μ out of range.
    static QuasistaticModel from(const RestState& rest, const QuasistaticStiffness& stiffness = {}, double mu = 0.1);
};

struct QuasistaticOptions {
    enum class Method {
        fast,      ///< Newton on the exact Hessian, each system by conjugate gradients with an incomplete Cholesky
                   ///< factor of the projected Hessian, left at the first direction of negative curvature
        newton_cg  ///< the paper's route: projected Newton, each system by conjugate gradients (block Jacobi)
    };
    Method method = Method::fast;
    double tolerance = 1e-6;    ///< of `Report::residual`; in [1e-12, 1e-1]
    int max_iterations = 2000;  ///< Newton steps a sample may take; at least 1

    /// Throws Error naming field, value and bound.
    void validate() const;
};

/// Solutions of a batch, contiguous by sample. In a report, `iterations` are Newton steps, `sweeps` iterations of
/// conjugate gradients.
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
///
/// The energy is not convex: cloth may buckle to either side. From a prediction the solver descends to a minimum nearby
/// and never climbs. Where springs that want a length have none (cloth collapsed to a point) or a whole prediction lies
/// on a line or in a plane, no direction to buckle is given, and the start is shaken by a thousandth of an edge, the
/// same way every time.
///
///     prior::Quasistatic prior(prior::QuasistaticModel::from(prior::rest_state(mesh)));
///     prior::Quasistatic::Workspace workspace(prior);
///     prior::QuasistaticSolution solution;
///     prior.project(predicted, solution, workspace);                            // predicted: [N x V x 3]
///     prior.backward(predicted, solution, loss_gradient, gradient, workspace);  // ∂L/∂r* -> ∂L/∂r̂, ∂L/∂μ, ...
class Quasistatic {
  public:
    class Workspace;

    /// Throws Error for a model or options that make no sense.
    explicit Quasistatic(QuasistaticModel model, const QuasistaticOptions& options = {});
    ~Quasistatic();
    Quasistatic(Quasistatic&&) noexcept;

    const QuasistaticModel& model() const;
    const QuasistaticOptions& options() const;
    /// μ_i `[V]` for the same mesh: keeps all symbolic work. Not while other threads use it.
    void set_mu(const Eigen::VectorXd& mu_vertex);

    /// Projects `predicted` `[N x V x 3]`. With `warm_start`, `solution` holds an earlier solution of these samples
    /// (one that does not fit is an Error); otherwise what it holds is replaced.
    void project(std::span<const double> predicted, QuasistaticSolution& solution, Workspace& workspace,
                 bool warm_start = false) const;
    /// Vector-Jacobian product with the exact Hessian H at r* (method.md, Section 3; paper, Equations 14 and 16):
    /// H η = ∂L/∂r*, then ∂L/∂r̂_i = μ_i k^Z_i η_i and so on. Where conjugate gradients meet negative curvature or
    /// stall, a complete factorisation takes over and decides. If H is not positive definite, r* is no strict minimum
    /// and has no derivative; the projected Hessian then takes the place of H, and the report says so. The report's
    /// `active_set_distance` is 1: the energy has no active set. A sample that was rejected gets NaN.
    void backward(std::span<const double> predicted, const QuasistaticSolution& solution,
                  std::span<const double> loss_gradient, QuasistaticGradient& gradient, Workspace& workspace) const;
    /// Jacobian-vector product, with the same Hessian.
    void tangent(std::span<const double> predicted, const QuasistaticSolution& solution,
                 const QuasistaticChange& change, QuasistaticTangent& tangent, Workspace& workspace) const;

    struct Impl;

  private:
    void sort_samples(std::span<const double> predicted, int count, Workspace& workspace) const;
    void project_hard(std::span<const double> predicted, QuasistaticSolution& solution, Workspace& workspace) const;

    std::unique_ptr<Impl> impl_;
};

/// The buffers of one caller: sized at the first call of each kind, reused afterwards. `threads` share a batch's work.
class Quasistatic::Workspace {
  public:
    explicit Workspace(const Quasistatic& prior, int threads = 1);
    ~Workspace();
    Workspace(Workspace&&) noexcept;

    struct Buffers;

  private:
    friend class Quasistatic;
    std::unique_ptr<Buffers> buffers_;
};

/// One sample, once: builds the class and throws it away.
QuasistaticSolution project_quasistatic(const ClothMesh& mesh, const Positions& predicted, double mu = 0.1,
                                        const QuasistaticStiffness& stiffness = {},
                                        const QuasistaticOptions& options = {});

/// |∇E(r)|_∞ / max(|∇E(r̂)|_∞, mean_e k^L_e l̄_e), the residual that the contract defines. A spring of length zero that
/// wants one pulls nowhere in ∇E(r̂), but counts with its full force k l̄ at r: such a point is no minimum.
double quasistatic_residual(const QuasistaticModel& model, std::span<const double> predicted,
                            std::span<const double> position);

}  // namespace toile::prior

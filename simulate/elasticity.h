#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "cloth/bending.h"
#include "cloth/block_values.h"
#include "cloth/cloth_mesh.h"
#include "cloth/fold.h"
#include "cloth/membrane.h"
#include "cloth/strain_limit.h"
#include "cloth/topology.h"
#include "simulate/material.h"

namespace toile::simulate {

/// Membrane, bending, strain limit and weight of one garment: energy, gradient and Hessian in the positions. Const and
/// shared by threads.
class Elasticity {
  public:
    Elasticity(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
               const std::optional<BendingOptions>& bending, const Eigen::Vector3d& gravity,
               const std::optional<StrainLimitOptions>& strain_limit = std::nullopt);

    /// Vertex pairs that share a stencil: the Hessian's graph.
    std::vector<std::pair<int, int>> pairs() const;
    /// Looks up where each stencil's blocks go; call once with the matrix' graph.
    void bind(const BlockSymbolic& symbolic);

    /// With the stiffness that the garment's weight asks for, if the scene has one.
    const std::optional<StrainLimit>& strain_limit() const { return strain_limit_; }

    double energy(const Positions& x) const;
    void add_gradient(const Positions& x, Positions& gradient) const;
    /// The projected Hessian, positive semidefinite.
    void add_hessian(const Positions& x, BlockValues& hessian) const;
    /// What `add_hessian` lacks of the true Hessian: multiples of the identity on the graph it is bound to, in order of
    /// slots, as far as they depend on x. Folded hinges and strain limits stay projected.
    void find_softening(const Positions& x, std::vector<double>& softening) const;
    /// Adds the product of all that `add_hessian` lacks with `way` `[V x 3]`.
    void add_softened(const std::vector<double>& softening, const Positions& way, Positions& product) const;

  private:
    struct Triangle {
        std::array<int, 3> vertex, slot;  // slots of corner pairs (1,0), (2,1), (0,2)
        MembraneStencil stencil;
    };
    /// A hinge that is flat at rest: E = ½ |Σ w x|², the stiffness in the weights.
    struct FlatHinge {
        std::array<int, 4> vertex;
        Eigen::Vector4d weight;
    };
    struct FoldedHinge {
        std::array<int, 4> vertex;
        std::array<int, 6> slot;
        FoldStencil stencil;
    };

    void add_bending(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options);
    void add_strain_limit(const MembraneOptions& membrane, const StrainLimitOptions& options, double weight);
    void add_hessian(const Triangle& triangle, const TriangleHessian& local, BlockValues& hessian) const;
    void add_hessian(const FoldedHinge& hinge, const FoldHessian& local, BlockValues& hessian) const;

    MembraneStiffness stiffness_;
    std::optional<StrainLimit> strain_limit_;
    std::vector<Triangle> triangle_;
    double bending_stiffness_ = 0.0;
    std::vector<FlatHinge> flat_hinge_;  // empty without bending; else one of the two is
    std::vector<FoldedHinge> folded_hinge_;
    bool couples_opposite_ = true;  // of flat hinges, in the Hessian
    struct Opposite {
        int first, second;
        double value;
    };
    std::vector<Opposite> opposite_;         // couplings that the Hessian has on its diagonal instead
    std::vector<std::pair<int, int>> pair_;  // of the graph it is bound to
    std::vector<double> flat_hessian_;       // of all flat hinges: what each slot's identity is multiplied with
    Positions weight_;                       // force of gravity on each vertex [N]
};

}  // namespace toile::simulate

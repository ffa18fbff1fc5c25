#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "cloth/bending.h"
#include "cloth/block_values.h"
#include "cloth/cloth_mesh.h"
#include "cloth/membrane.h"
#include "cloth/topology.h"
#include "simulate/material.h"

namespace toile::simulate {

/// Membrane, bending and weight of one garment: energy, gradient and Hessian in the positions. Const and shared by
/// threads.
class Elasticity {
  public:
    Elasticity(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
               const std::optional<BendingOptions>& bending, const Eigen::Vector3d& gravity);

    /// Vertex pairs that share a stencil: the Hessian's graph.
    std::vector<std::pair<int, int>> pairs() const;
    /// Looks up where each stencil's blocks go; call once with the matrix' graph.
    void bind(const BlockSymbolic& symbolic);

    double energy(const Positions& x) const;
    void add_gradient(const Positions& x, Positions& gradient) const;
    /// The projected Hessian, positive semidefinite. (On garments the true one was indefinite in two iterations of
    /// three and saved none.)
    void add_hessian(const Positions& x, BlockValues& hessian) const;

  private:
    TrianglePositions corners(const Positions& x, int triangle) const;

    const ClothMesh& mesh_;
    MembraneStiffness stiffness_;
    std::vector<MembraneStencil> membrane_;
    std::vector<std::array<int, 3>> membrane_slot_;  // of corner pairs (1,0), (2,1), (0,2)
    double bending_stiffness_ = 0.0;
    Eigen::Matrix<int, -1, 4, Eigen::RowMajor> hinge_;  // empty without bending
    std::vector<BendingStencil> bending_;
    std::vector<std::array<int, 6>> bending_slot_;
    Positions weight_;  // force of gravity on each vertex [N]
};

}  // namespace toile::simulate

#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"
#include "simulate/material.h"

namespace toile::simulate {

/// A spring between two vertices, for solvers that know nothing but lengths.
struct Spring {
    int first, second;
    double rest_length;  ///< in the flat pattern [m]
    double stiffness;    ///< force per change of length [N/m]
};

/// One spring an edge, in the topology's order, that together stand for the membrane. Springs of stiffness k_e along
/// unit directions t_e of the pattern give a triangle of area A the strain energy per area ½ Σ k_e l_e² (tᵉ·ε tᵉ)² / A;
/// k_e ≥ 0 are the least-squares fit of that quadratic form to the membrane's (cloth/membrane.h at small strain), but
/// for the couplings of stretch with shear, which triangles of other orientation take back. What no springs can do:
/// their form has Cauchy's symmetry (the coupling of warp and weft equals the shear stiffness), a triangle's shape
/// limits the rest, and at large strain force grows with length, not with its cube.
std::vector<Spring> membrane_springs(const ClothMesh& mesh, const Topology& topology,
                                     const Eigen::VectorXd& rest_length, const MembraneOptions& options);

/// One spring a hinge, between the two vertices opposite the shared edge; its rest length is their distance with the
/// hinge opened flat, or to the angle it starts from. Such a spring has no moment on a flat hinge: its energy grows
/// with the fourth power of a small angle, where a hinge's grows with the second. Its stiffness makes the two energies
/// equal 1 rad from rest: softer than the material below, stiffer above.
std::vector<Spring> bending_springs(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options);

}  // namespace toile::simulate

#pragma once

#include <string_view>
#include <vector>

#include "simulate/material.h"

namespace toile::simulate {

/// A fabric that was measured.
struct Fabric {
    std::string_view name;         ///< of the preset: "denim"
    std::string_view what;         ///< what it is, and its name in the source
    MembraneOptions membrane;      ///< converted, see below
    double bending_stiffness = 0;  ///< [N m]
};

/// The ten fabrics of Wang, O'Brien, Ramamoorthi 2011, "Data-driven elastic models for cloth: modeling and measurement"
/// (ACM Transactions on Graphics 30(4), 71), from the database that goes with it, which is written for the simulator
/// ARCSim. The source has a stiffness matrix (c11, c12, c22, c33) [N/m] without stretch and for a stretch of 1/6 in
/// five directions, between which it interpolates, and a bending stiffness for three directions and five curvatures.
/// All numbers are as measured; one number for each key of ours takes a conversion:
///
/// - density as it is [kg/m^2];
/// - the source's first axis is our weft and the second our warp (the stiffer one in nine of ten; the denim's elastane
///   runs along the first);
/// - stiffnesses are the secant ones at a stretch of 5 %, three tenths of the way to 1/6: c_uu where the first axis is
///   pulled, c_vv where the second is, c_uv the mean of both, c_s where the bias is pulled. As ARCSim reads them, the
///   matrix counts twice: ψ = c11 ε_uu² + 2 c12 ε_uu ε_vv + c22 ε_vv² + 2 c33 ε_uv². Thus c_uu = 2 c11, c_s = c33;
/// - the Poisson ratio is c_uv / √(c_uu c_vv), within 0 and 0.49;
/// - bending stiffness is the mean over directions at a curvature of 20 1/m (a fold of 5 cm radius), divided by 4: the
///   source's hinge has k |e|² θ² / (8 (A_0 + A_1)), ours ½ k |e|² θ² / (A_0 + A_1).
///
/// What it leaves out: knits stiffen by a factor of 2 to 10 on the way to a stretch of 1/6, and bending differs between
/// directions by up to 2.
const std::vector<Fabric>& measured_fabrics();

}  // namespace toile::simulate

#pragma once

#include <map>
#include <optional>
#include <string>

#include "simulate/certificate.h"

namespace toile::simulate {

/// Who asks.
///
/// `strict`, the default: at rest (force and speed), no vertex deeper than 0.1 mm below the body's mesh, no crossing
/// triangles, stretch within the material's limit.
///
/// `paper`: what published data sets of draped cloth are checked for, if at all: at rest, finite, penetration up to
/// 1 mm, stretch up to 1.3. Crossings of the cloth with itself are counted, not bounded.
///
/// `garmentcode`: the quality filter of GarmentCode's simulator (sim_props: max_body_collisions 35,
/// max_self_collisions 300, non_static_percent 1.5), to count like with like: up to 35 triangle pairs of cloth and body
/// and 300 of the cloth that cross, at most 1.5 % of the vertices on the move. Neither force, depth nor stretch.
enum class GateProfile { strict, paper, garmentcode };

/// The largest values of an accepted drape's certificate. What is absent is not asked.
struct GateOptions {
    GateProfile profile = GateProfile::strict;      ///< where the bounds below came from
    std::optional<double> residual_force = 0.001;   ///< over the garment's weight
    std::optional<double> max_speed = 0.001;        ///< [m/s]
    std::optional<double> moving_share;             ///< of the vertices, see `Certificate`
    std::optional<double> body_penetration = 1e-4;  ///< [m]
    std::optional<int> body_crossings;              ///< triangle pairs of cloth and body
    std::optional<int> self_intersections = 0;      ///< triangle pairs of the cloth
    std::optional<double> max_stretch = 1.3;        ///< edge length over rest length
};

/// The bounds of a profile.
GateOptions gate_of(GateProfile profile);

/// The first thing a drape is to be refused for, in this order: not finite, not at rest, penetration of the body,
/// crossings, overstretched. A bound that is not met because the value is NaN is not met.
DrapeStatus judge(const Certificate& certificate, bool finite, const GateOptions& gate);

/// Bound by name of the certificate's dataset, for those that are asked.
std::map<std::string, double> gate_bounds(const GateOptions& gate);

}  // namespace toile::simulate

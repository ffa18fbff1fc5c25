#pragma once

#include <optional>

#include "simulate/drape.h"
#include "skin/pose.h"

namespace toile::evaluate {

/// What one case of the stability suite drapes: in the neutral pose, then in `pose`, where there is one.
struct StabilityScene {
    simulate::DrapeScene drape;
    std::optional<skin::Pose> pose;
};

// The scenes that the cases vary: 200 to 1,000 vertices, default material. The gate asks for rest and for no
// penetration; stretch is not judged, as soft cloth stretches.

/// A square that starts level and swings down from two pinned corners.
StabilityScene hanging_square();
/// A square dropped on a sphere, a floor below it for what slips off.
StabilityScene square_on_sphere();
/// A square pinned at two corners that comes down on a sphere, at rest with any friction.
StabilityScene leaning_square();
/// A square dropped on a table.
StabilityScene square_on_table();
/// A square dropped on a pillar whose upper half then bends.
StabilityScene square_on_pillar();
/// A curtain, pinned along its top, into which the upper half of a pillar swings.
StabilityScene struck_curtain();
/// The built-in T-shirt on the built-in body, both arms then raised.
StabilityScene tshirt();

}  // namespace toile::evaluate

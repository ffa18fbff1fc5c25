#pragma once

#include "skin/body.h"
#include "skin/pose.h"

namespace toile::skin {

/// The simplest body that bends, to try solvers on: an upright pillar of radius 0.1 m and height 1 m on the ground with
/// two joints, at the ground ("lower") and half way up ("upper"); the weights pass over between 0.4 and 0.6 m.
Body pillar_body();

/// The pillar's upper half bent sideways, towards -x, by `angle` [rad].
Pose bent_pillar(double angle);

}  // namespace toile::skin

#pragma once

#include <string_view>
#include <vector>

#include "simulate/certificate.h"
#include "skin/pose.h"

namespace toile::skin {
struct Body;
}

namespace toile::simulate {

/// What happens to a drape that misses its gate: it is tried again, each time with more effort.
///
///     rung 0  as configured
///          1  smaller steps: half the joint step and half the time step, twice the iterations a path step may take,
///          and
///             level sets of half the voxel
///          2  a longer path, in those steps: first the trunk with the limbs as in the neutral pose, then upper arms
///          and
///             legs, then lower ones, each leg of the way followed by a rest
///          3  another start, along that path: the neutral drape made anew with ten times the damping, and the double
///             budget to come to rest
///
/// A scene without a pose to go to has no path, and passes over rung 2. The drape that is kept is the first accepted
/// one; without one, that which got furthest through the gate, then that with the smallest residual. What a rung does
/// depends on the scene alone; it is bounded by the solver's iteration budget.
struct LadderOptions {
    int tries = 3;  ///< after the first, 0 to 3
};
std::string_view rung_name(int rung);

/// What came of one try.
struct TryRecord {
    int rung = 0;
    DrapeStatus status = DrapeStatus::accepted;
    Certificate certificate;  ///< of this try alone
};

struct DrapeScene;
struct DrapeResult;

/// The scene with a rung's settings.
DrapeScene rung_scene(const DrapeScene& scene, int rung);
/// The poses to pass through on a rung, the last of them `pose` `[J x 3]`; two that are the same are passed once.
std::vector<skin::Pose> rung_path(const skin::Body& body, const skin::Pose& pose, int rung);
/// The rungs to be tried, in order: 0 and up to `tries` more.
std::vector<int> rungs(const LadderOptions& options, bool with_path);
/// Whether a drape is better than another one, neither of them accepted.
bool better(const DrapeResult& one, const DrapeResult& other);

}  // namespace toile::simulate

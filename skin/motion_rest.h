#pragma once

#include <optional>

#include "files/motion_file.h"
#include "skin/role.h"

namespace toile::skin {

/// The frame to take for the rest pose of a motion whose file's own is no standing person: some files lay all bones
/// along one axis and keep the bearing of each in the rotations. Returns nothing where the rest pose will do, its legs
/// pointing away from its head, or where the skeleton has no legs or nothing above the pelvis to tell by. Otherwise the
/// frame in which the person stands straightest.
std::optional<int> standing_frame(const files::Motion& motion, const RoleMap& role);

/// The same motion, joint positions and all, with `frame` for its rest pose.
files::Motion with_rest_frame(const files::Motion& motion, int frame);

}  // namespace toile::skin

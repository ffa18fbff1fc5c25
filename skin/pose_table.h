#pragma once

#include <string>

#include "skin/body.h"
#include "skin/pose_source.h"

namespace toile::skin {

/// Poses from a table of joint angles [rad] in a CSV or HDF5 file (`files::read_table`), one a row. Columns are
///
/// - `<joint>.x`, `.y`, `.z`: the axis-angle rotation θ of a joint in its own bind frame, the joint by its name in the
///   rig or else by its role; components that are left out are zero;
/// - `<role>.raise`, `.swing`, `.twist`: anatomical angles (`RoleAngles`); those that are left out keep the role's bind
///   angle.
///
/// A table without column names must have three columns for each joint of the body, in its order. Throws Error with
/// file and line (or dataset) for an unknown column, a joint given both ways, a table of the wrong width, a dataset
/// made with a body of other bind axes, and all that `files::read_table` refuses.
PoseList read_pose_table(const Body& body, const std::string& path);

}  // namespace toile::skin

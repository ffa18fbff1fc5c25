#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cloth/types.h"
#include "files/rigged_file.h"
#include "skin/bind_skeleton.h"
#include "skin/role.h"

namespace toile::skin {

/// How bind space becomes ours: position = metres_per_unit * rotation * bind_position. Metres, y up, facing +z.
struct BodyFrame {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< turns axes into axes
    double metres_per_unit = 1;
    std::vector<std::string> remarks;
};

/// The axes follow the body: from feet to head is up, from the right limbs to the left ones is left. Without enough
/// joints of known role they follow the file's scene. `up` is "auto", or the axis of bind space that points up ("x",
/// "y", "z", "-x", "-y", "-z"), the body then facing along -y for "z" and +z for "y" unless its limbs say otherwise.
///
/// The unit is what the file says where that makes a body of 0.5 to 2.5 m; otherwise a power of ten of the metre, an
/// inch or a foot, whichever brings the height nearest to a person's. `metres_per_unit` above 0 sets it.
///
/// `role_joint` indexes `skeleton.joint`; `position` `[V x 3]` is the surface in bind space. Throws Error naming
/// `where` for another word in `up`, or a height that no unit explains.
BodyFrame body_frame(const files::RiggedFile& file, const BindSkeleton& skeleton, const RoleMap& role_joint,
                     const Positions& position, const std::string& up, double metres_per_unit,
                     const std::string& where);

}  // namespace toile::skin

#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "cloth/types.h"

namespace toile::files {

/// A skeleton's motion, in the file's own unit and axes. In its rest pose every joint's rotation is the identity, so a
/// joint's global rotation, the product of the local ones from the root on, is also its rotation relative to rest.
struct Motion {
    std::vector<std::string> joint_name;
    std::vector<int> joint_parent;  ///< smaller than the joint's own index; -1 for the root, which is joint 0
    Positions rest_offset;          ///< `[J x 3]` from the parent's rest position
    Positions end_offset;           ///< `[J x 3]` from a joint that ends a chain to the chain's tip, else zero
    double frame_time = 0;          ///< [s]; zero where the file says so
    int frame_count = 0;
    std::vector<Eigen::Quaterniond> rotation;  ///< `[frames x J]`, local, unit
    Positions root_translation;                ///< `[frames x 3]`, as the root's position channels give it

    int joint_count() const { return static_cast<int>(joint_name.size()); }
    const Eigen::Quaterniond& local_rotation(int frame, int joint) const {
        return rotation[static_cast<std::size_t>(frame) * joint_name.size() + joint];
    }
};

/// Rest positions of the joints `[J x 3]`, the root at the origin.
Positions rest_positions(const Motion& motion);

/// Reads BVH: any channel order, one to six channels a joint. Position channels of joints other than the root are left
/// out. Spaces in joint names become underscores. Angles pass through single precision (about 1e-5 rad). Throws Error
/// with file and line for a missing, empty or binary file, a broken hierarchy, fewer or more values than the frames
/// announced need, no frame at all, and values that are not numbers.
Motion read_motion(const std::string& path);

}  // namespace toile::files

#include "skin/motion_rest.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

namespace toile::skin {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<Quaterniond> global_rotations(const files::Motion& motion, int frame) {
    std::vector<Quaterniond> global;
    for (int j = 0; j < motion.joint_count(); ++j) {
        const Quaterniond& local = motion.local_rotation(frame, j);
        const int parent = motion.joint_parent[j];
        global.push_back(parent < 0 ? local : (global[parent] * local).normalized());
    }
    return global;
}

/// How much the legs, each from hip to knee to foot, point away from the head: 1 for a person who stands straight.
/// `global` holds the joints' rotations, or is empty for the file's rest pose.
std::optional<double> straightness(const files::Motion& motion, const RoleMap& role,
                                   const std::vector<Quaterniond>& global) {
    std::vector<Vector3d> position;
    for (int j = 0; j < motion.joint_count(); ++j) {
        Vector3d offset = motion.rest_offset.row(j).transpose();
        const int parent = motion.joint_parent[j];
        if (parent >= 0 && !global.empty()) offset = global[parent] * offset;
        position.push_back(parent < 0 ? offset : Vector3d(position[parent] + offset));
    }
    const auto between = [&](Role from, Role to) -> std::optional<Vector3d> {
        if (role[from] < 0 || role[to] < 0) return {};
        const Vector3d bone = position[role[to]] - position[role[from]];
        if (!(bone.norm() > 1e-9)) return {};
        return bone.normalized();
    };
    std::optional<Vector3d> trunk;
    for (const Role top : {Role::head, Role::neck, Role::chest, Role::spine})
        if (!trunk) trunk = between(Role::pelvis, top);
    if (!trunk) return {};
    double sum = 0;
    int bones = 0;
    for (const auto& [from, to] :
         {std::pair{Role::left_upper_leg, Role::left_lower_leg}, std::pair{Role::left_lower_leg, Role::left_foot},
          std::pair{Role::right_upper_leg, Role::right_lower_leg}, std::pair{Role::right_lower_leg, Role::right_foot}})
        if (const std::optional<Vector3d> bone = between(from, to)) {
            sum -= bone->dot(*trunk);
            ++bones;
        }
    if (bones == 0) return {};
    return sum / bones;
}

}  // namespace

std::optional<int> standing_frame(const files::Motion& motion, const RoleMap& role) {
    constexpr double stands = 0.5;  // cosine of 60 degrees
    constexpr int most_frames = 1000;
    const std::optional<double> rest = straightness(motion, role, {});
    if (!rest || *rest > stands) return {};
    const int step = 1 + (motion.frame_count - 1) / most_frames;
    int best = 0;
    double straightest = -2;
    for (int frame = 0; frame < motion.frame_count; frame += step) {
        const double value = straightness(motion, role, global_rotations(motion, frame)).value_or(-2);
        // A first frame is often a calibration pose: a later one must be clearly better.
        if (value > straightest + 0.01) {
            straightest = value;
            best = frame;
        }
    }
    return best;
}

files::Motion with_rest_frame(const files::Motion& motion, int frame) {
    // With G the joints' rotations in that frame, a joint's local rotation L becomes G_parent L G^-1, which is the
    // identity in the frame itself; bones are turned to where they point there.
    const std::vector<Quaterniond> global = global_rotations(motion, frame);
    files::Motion based = motion;
    for (int j = 0; j < motion.joint_count(); ++j) {
        const int parent = motion.joint_parent[j];
        const Quaterniond carrier = parent < 0 ? Quaterniond::Identity() : global[parent];
        based.rest_offset.row(j) = (carrier * motion.rest_offset.row(j).transpose()).transpose();
        based.end_offset.row(j) = (global[j] * motion.end_offset.row(j).transpose()).transpose();
        for (int f = 0; f < motion.frame_count; ++f)
            based.rotation[static_cast<std::size_t>(f) * motion.joint_name.size() + j] =
                (carrier * motion.local_rotation(f, j) * global[j].conjugate()).normalized();
    }
    return based;
}

}  // namespace toile::skin

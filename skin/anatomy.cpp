#include "skin/anatomy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cloth/error.h"

namespace toile::skin {
namespace {

enum class Family { trunk, clavicle, upper_arm, lower_arm, hand, leg };

Family family(Role role) {
    switch (role) {
        case Role::left_clavicle:
        case Role::right_clavicle:
            return Family::clavicle;
        case Role::left_upper_arm:
        case Role::right_upper_arm:
            return Family::upper_arm;
        case Role::left_lower_arm:
        case Role::right_lower_arm:
            return Family::lower_arm;
        case Role::left_hand:
        case Role::right_hand:
            return Family::hand;
        case Role::left_upper_leg:
        case Role::left_lower_leg:
        case Role::left_foot:
        case Role::right_upper_leg:
        case Role::right_lower_leg:
        case Role::right_foot:
            return Family::leg;
        default:
            return Family::trunk;
    }
}

/// +1 for the body's left and its middle, -1 for its right.
double side(Role role) {
    return role_name(role).starts_with("right_") ? -1 : 1;
}

/// The same segment further in (step -1) or out (step +1) along an arm.
Role along_arm(Role role, int step) {
    return static_cast<Role>(static_cast<int>(role) + step);
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// Raise after swing after twist for arms: the bone lies along +-x at zero. A mirror image in x turns the other way
/// about y and z.
Eigen::Matrix3d arm_rotation(const Eigen::Vector3d& angle, double mirror) {
    return about(Eigen::Vector3d::UnitZ(), mirror * angle[0]) * about(Eigen::Vector3d::UnitY(), -mirror * angle[1]) *
           about(Eigen::Vector3d::UnitX(), angle[2]);
}

Eigen::Matrix3d trunk_rotation(const Eigen::Vector3d& angle) {
    return about(Eigen::Vector3d::UnitZ(), -angle[0]) * about(Eigen::Vector3d::UnitX(), angle[1]) *
           about(Eigen::Vector3d::UnitY(), angle[2]);
}

Eigen::Matrix3d leg_rotation(const Eigen::Vector3d& angle, double mirror) {
    return about(Eigen::Vector3d::UnitZ(), mirror * angle[0]) * about(Eigen::Vector3d::UnitX(), -angle[1]) *
           about(Eigen::Vector3d::UnitY(), mirror * angle[2]);
}

/// (raise, swing, 0) of a direction, such that arm_rotation turns the T pose's bone to it.
Eigen::Vector3d arm_angles(const Eigen::Vector3d& direction, double mirror) {
    const double outwards = mirror * direction.x();
    return {std::atan2(direction.y(), outwards), std::atan2(direction.z(), std::hypot(outwards, direction.y())), 0.0};
}

Eigen::Vector3d bind_position(const Body& body, int joint) {
    return body.joint[joint].bind.topRightCorner<3, 1>();
}

int joint_of(const Body& body, Role role) {
    const int joint = body.role[role];
    if (joint < 0)
        throw Error("the body has no joint for the role " + std::string(role_name(role)), {},
                    "name its joint in the role map");
    return joint;
}

/// Unit direction of an arm's bone in the bind pose: towards the next joint out, or towards its first child.
Eigen::Vector3d bone_direction(const Body& body, Role role) {
    const int joint = joint_of(body, role);
    int next = body.role[along_arm(role, 1)];
    for (int j = joint + 1; next < 0 && j < body.joint_count(); ++j)
        if (body.joint[j].parent == joint) next = j;
    if (next < 0) joint_of(body, along_arm(role, 1));
    const Eigen::Vector3d bone = bind_position(body, next) - bind_position(body, joint);
    if (!(bone.norm() > 1e-6))
        throw Error("the bone of the role " + std::string(role_name(role)) + " has no length", {},
                    "give another joint in the role map");
    return bone.normalized();
}

/// Axes of an arm's segment in the bind pose: those that are the body's own axes in the T pose.
Eigen::Matrix3d arm_frame(const Body& body, Role role) {
    if (family(role) == Family::upper_arm) return arm_rotation(bind_angles(body, role), side(role));
    const Role inner = along_arm(role, -1);
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
    if (body.role[inner] >= 0) frame = arm_frame(body, inner);
    if (family(role) == Family::hand) return frame;
    return frame * arm_rotation(bind_angles(body, role), side(role));
}

/// The clavicle's share of the arm's raise: none up to the horizontal, a third of what is beyond the first half radian,
/// with a parabola between; less as the arm points ahead, where raise loses its meaning.
double clavicle_share(const Eigen::Vector3d& angle) {
    constexpr double onset = 0.5;
    const double raise = std::clamp(angle[0], 0.0, M_PI / 2);
    const double above = raise < onset ? raise * raise / (2 * onset) : raise - onset / 2;
    return above / 3 * std::max(0.0, std::cos(angle[1]));
}

/// Rotations of the joints relative to the bind pose, in the world's axes, filled from the root outwards.
struct WorldRotations {
    const Body& body;
    std::vector<Eigen::Matrix3d> turned;

    Eigen::Matrix3d of_parent(int joint) const {
        const int parent = body.joint[joint].parent;
        return parent < 0 ? Eigen::Matrix3d::Identity().eval() : turned[parent];
    }
    /// What an upper arm is measured against: the chest, or else what carries the clavicle or the arm.
    Eigen::Matrix3d of_chest(Role arm) const {
        const int joint = body.role[arm];
        const int chest = body.role[Role::chest];
        if (chest >= 0 && chest < joint) return turned[chest];
        const int clavicle = body.role[along_arm(arm, -1)];
        return of_parent(clavicle >= 0 ? clavicle : joint);
    }
};

/// The rotation of `joint` relative to its parent, in the world's axes of the bind pose, for the angles of its role.
Eigen::Matrix3d role_rotation(const WorldRotations& world, Role role, int joint, const Eigen::Vector3d& angle) {
    const Body& body = world.body;
    const double mirror = side(role);
    switch (family(role)) {
        case Family::trunk:
            return trunk_rotation(angle);
        case Family::leg:
            return leg_rotation(angle, mirror);
        case Family::clavicle:
            return arm_rotation(angle, mirror);
        case Family::upper_arm: {
            const Eigen::Matrix3d from_bind = arm_rotation(angle, mirror) * arm_frame(body, role).transpose();
            return world.of_parent(joint).transpose() * world.of_chest(role) * from_bind;
        }
        case Family::lower_arm: {
            const Eigen::Matrix3d bind = arm_frame(body, role);
            const Eigen::Matrix3d straight = bind * arm_rotation(bind_angles(body, role), mirror).transpose();
            return straight * arm_rotation(angle, mirror) * bind.transpose();
        }
        case Family::hand: {
            const Eigen::Matrix3d frame = arm_frame(body, role);
            return frame * arm_rotation(angle, mirror) * frame.transpose();
        }
    }
    return Eigen::Matrix3d::Identity();
}

/// The named angles, and the clavicles' share of raised arms.
std::map<Role, Eigen::Vector3d> with_clavicles(const Body& body, const RoleAngles& angles) {
    std::map<Role, Eigen::Vector3d> all = angles.angle;
    for (const Role arm : {Role::left_upper_arm, Role::right_upper_arm}) {
        const Role clavicle = along_arm(arm, -1);
        const auto raised = angles.angle.find(arm);
        if (raised == angles.angle.end() || angles.angle.count(clavicle) || body.role[clavicle] < 0) continue;
        const double share = clavicle_share(raised->second) - clavicle_share(bind_angles(body, arm));
        all[clavicle] = {share, 0, 0};
    }
    return all;
}

}  // namespace

Pose pose_from_angles(const Body& body, const RoleAngles& angles) {
    std::vector<const std::pair<const Role, Eigen::Vector3d>*> of_joint(body.joint.size(), nullptr);
    const auto all = with_clavicles(body, angles);
    for (const auto& entry : all) {
        if (!entry.second.allFinite())
            throw Error("an angle of the role " + std::string(role_name(entry.first)) + " is not finite");
        auto& slot = of_joint[joint_of(body, entry.first)];
        if (slot)
            throw Error("the roles " + std::string(role_name(slot->first)) + " and " +
                        std::string(role_name(entry.first)) + " are one joint of this body: give angles to one");
        slot = &entry;
    }
    Pose pose = Pose::Zero(body.joint_count(), 3);
    WorldRotations world{body, std::vector<Eigen::Matrix3d>(body.joint.size())};
    for (int j = 0; j < body.joint_count(); ++j) {
        world.turned[j] = world.of_parent(j);
        if (!of_joint[j]) continue;
        const Eigen::Matrix3d turn = role_rotation(world, of_joint[j]->first, j, of_joint[j]->second);
        const Eigen::Matrix3d bind = body.joint[j].bind.topLeftCorner<3, 3>();
        const Eigen::AngleAxisd local(Eigen::Quaterniond(Eigen::Matrix3d(bind.transpose() * turn * bind)).normalized());
        pose.row(j) = (local.angle() * local.axis()).transpose();
        world.turned[j] = world.turned[j] * turn;
    }
    return pose;
}

Eigen::Vector3d bind_angles(const Body& body, Role role) {
    const int joint = joint_of(body, role);
    if (family(role) == Family::upper_arm) return arm_angles(bone_direction(body, role), side(role));
    if (family(role) != Family::lower_arm) return Eigen::Vector3d::Zero();
    const Role upper = along_arm(role, -1);
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
    if (body.role[upper] >= 0 && body.role[upper] != joint) frame = arm_frame(body, upper);
    return arm_angles(frame.transpose() * bone_direction(body, role), side(role));
}

JointLimit default_limit(Role role) {
    switch (role) {
        case Role::pelvis:
            return {{-0.3, -0.3, -0.5}, {0.3, 0.3, 0.5}};
        case Role::spine:
        case Role::chest:
            return {{-0.25, -0.2, -0.3}, {0.25, 0.4, 0.3}};
        case Role::neck:
        case Role::head:
            return {{-0.3, -0.4, -0.6}, {0.3, 0.4, 0.6}};
        case Role::left_upper_leg:
        case Role::right_upper_leg:
            return {{-0.1, -0.4, -0.4}, {0.7, 1.5, 0.5}};
        case Role::left_lower_leg:
        case Role::right_lower_leg:
            return {{0.0, -2.0, 0.0}, {0.0, 0.0, 0.0}};
        case Role::left_foot:
        case Role::right_foot:
            return {{-0.2, -0.5, -0.3}, {0.2, 0.3, 0.3}};
        case Role::left_clavicle:
        case Role::right_clavicle:
            return {{-0.15, -0.2, 0.0}, {0.45, 0.3, 0.0}};
        case Role::left_upper_arm:
        case Role::right_upper_arm:
            return {{-1.4, -0.5, -0.8}, {1.5, 1.3, 0.8}};
        case Role::left_lower_arm:
        case Role::right_lower_arm:
            return {{0.0, 0.0, -0.8}, {0.0, 2.2, 0.8}};
        case Role::left_hand:
        case Role::right_hand:
            return {{-0.8, -0.4, 0.0}, {0.8, 0.4, 0.0}};
    }
    return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
}

void check_limit(Role role, const JointLimit& limit, const std::string& where) {
    constexpr std::array<const char*, 3> axis = {"raise", "swing", "twist"};
    for (int i = 0; i < 3; ++i) {
        const std::string name = std::string(axis[i]) + " of " + std::string(role_name(role));
        std::string range = "[";
        range.append(std::to_string(limit.lower[i])).append(", ").append(std::to_string(limit.upper[i])).append("]");
        if (!std::isfinite(limit.lower[i]) || !std::isfinite(limit.upper[i]))
            throw Error("the limit " + range + " for the " + name + " is not finite", where);
        if (limit.lower[i] > limit.upper[i])
            throw Error("the limit " + range + " for the " + name + " is reversed", where,
                        "give the lower limit first, in radians");
        if (limit.lower[i] < -2 * M_PI || limit.upper[i] > 2 * M_PI)
            throw Error("the limit " + range + " for the " + name + " is beyond a whole turn", where,
                        "limits are in radians");
    }
}

}  // namespace toile::skin

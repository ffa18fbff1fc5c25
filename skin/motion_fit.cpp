#include "skin/motion_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "cloth/error.h"
#include "skin/role_names.h"

namespace toile::skin {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The role whose joint ends the bone of a limb's role.
std::optional<Role> bone_end(Role role) {
    switch (role) {
        case Role::left_upper_arm:
        case Role::left_lower_arm:
        case Role::right_upper_arm:
        case Role::right_lower_arm:
        case Role::left_upper_leg:
        case Role::left_lower_leg:
        case Role::right_upper_leg:
        case Role::right_lower_leg:
            return static_cast<Role>(static_cast<int>(role) + 1);
        default:
            return {};
    }
}

/// The limb's role further in, whose alignment this one starts from; none for what hangs on the trunk.
std::optional<Role> limb_parent(Role role) {
    const Role inner = static_cast<Role>(std::max(0, static_cast<int>(role) - 1));
    if (bone_end(inner) == role) return inner;
    return {};
}

int named_joint(const files::Motion& motion, std::string name, Role role, const std::string& where) {
    std::replace(name.begin(), name.end(), ' ', '_');  // as files::read_motion does
    const auto count = std::count(motion.joint_name.begin(), motion.joint_name.end(), name);
    const auto found = std::find(motion.joint_name.begin(), motion.joint_name.end(), name);
    if (count == 1) return static_cast<int>(found - motion.joint_name.begin());
    std::string all;
    for (const std::string& joint : motion.joint_name) all += (all.empty() ? "" : ", ") + joint;
    throw Error((count == 0 ? "the motion has no joint '" : "the motion has several joints '") + name +
                    "' for the role " + std::string(role_name(role)),
                where, "its joints are " + all);
}

bool descends(const files::Motion& motion, int joint, int ancestor) {
    while (joint > ancestor) joint = motion.joint_parent[joint];
    return joint == ancestor;
}

/// The last joint before the next roles further out: the one that carries all of them.
int end_of_role(const files::Motion& motion, const RoleMap& role, int joint) {
    int end = -1;
    for (const int next : role.joint) {
        if (next <= joint || !descends(motion, next, joint)) continue;
        int carrier = motion.joint_parent[next];
        if (end < 0) end = carrier;
        while (!descends(motion, end, carrier) && !descends(motion, carrier, end))
            carrier = motion.joint_parent[carrier];
        if (descends(motion, end, carrier)) end = carrier;
    }
    return end < 0 ? joint : end;
}

/// A skeleton at rest: where the joints of its roles are.
struct RestSkeleton {
    const RoleMap& role;
    std::vector<Vector3d> position;
    std::vector<Vector3d> tip;  ///< where the joint's first child is, or its chain's end; else the joint itself
    std::array<int, role_count> source = role.joint;  ///< the last joint of each role's bone

    std::optional<Vector3d> at(Role r) const {
        if (role[r] < 0) return {};
        return position[role[r]];
    }
    /// From a limb's joint along its bone, unit length; none where that cannot be told.
    std::optional<Vector3d> bone(Role r) const {
        const std::optional<Role> end = bone_end(r);
        if (role[r] < 0 || !end) return {};
        const int last = source[static_cast<int>(r)];
        const Vector3d to = role[*end] >= 0 ? position[role[*end]] : tip[last];
        Vector3d along = to - position[role[r]];
        // A role may begin at a helper joint beside the bone (a hip's in the middle of the pelvis).
        if (2 * (to - position[last]).norm() > along.norm()) along = to - position[last];
        if (!(along.norm() > 1e-9)) return {};
        return along.normalized();
    }
    /// Sum of the unit vectors from right to left hips and shoulders.
    Vector3d leftwards() const {
        Vector3d sum = Vector3d::Zero();
        for (const auto& [left, right] : {std::pair{Role::left_upper_leg, Role::right_upper_leg},
                                          std::pair{Role::left_upper_arm, Role::right_upper_arm}})
            if (at(left) && at(right)) sum += (*at(left) - *at(right)).stableNormalized();
        return sum;
    }
    /// From the pelvis to the uppermost joint of the trunk.
    Vector3d upwards() const {
        for (const Role top : {Role::head, Role::neck, Role::chest, Role::spine})
            if (at(top) && (*at(top) - *at(Role::pelvis)).norm() > 1e-9) return *at(top) - *at(Role::pelvis);
        return Vector3d::Zero();
    }
    /// Trunk and one leg, along the bones.
    double length() const {
        double sum = upwards().norm();
        std::optional<Vector3d> from = at(Role::left_upper_leg);
        for (const Role next : {Role::left_lower_leg, Role::left_foot}) {
            if (from && at(next)) sum += (*at(next) - *from).norm();
            if (at(next)) from = at(next);
        }
        return sum;
    }
};

RestSkeleton rest_of(const files::Motion& motion, const RoleMap& role) {
    RestSkeleton rest{role, {}, {}};
    for (int r = 0; r < role_count; ++r)
        if (role.joint[r] >= 0) rest.source[r] = end_of_role(motion, role, role.joint[r]);
    const Positions position = rest_positions(motion);
    for (int j = 0; j < motion.joint_count(); ++j) {
        rest.position.push_back(position.row(j).transpose());
        rest.tip.push_back((position.row(j) + motion.end_offset.row(j)).transpose());
    }
    for (int j = motion.joint_count() - 1; j > 0; --j) rest.tip[motion.joint_parent[j]] = rest.position[j];
    return rest;
}

RestSkeleton rest_of(const Body& body) {
    RestSkeleton rest{body.role, {}, {}};
    for (const Joint& joint : body.joint) rest.position.push_back(joint.bind.topRightCorner<3, 1>());
    rest.tip = rest.position;
    for (int j = body.joint_count() - 1; j > 0; --j)
        if (body.joint[j].parent >= 0) rest.tip[body.joint[j].parent] = rest.position[j];
    return rest;
}

Vector3d axis_from_name(const std::string& name, const std::string& where) {
    const std::string letter = name.starts_with('-') ? name.substr(1) : name;
    if (letter != "x" && letter != "y" && letter != "z")
        throw Error("up is '" + name + "'", where, "it should be auto, x, y, z, -x, -y or -z");
    return (name.size() > 1 ? -1.0 : 1.0) * Vector3d::Unit(letter[0] - 'x');
}

/// The way up of the rest skeleton: along an axis, unless it stands far aslant.
Vector3d find_up(const RestSkeleton& rest, const std::string& given, const std::string& where) {
    constexpr double aslant = 0.82;  // cosine of 35 degrees
    constexpr double across = 0.17;  // cosine of 80 degrees
    const Vector3d trunk = rest.upwards().stableNormalized();
    if (given != "auto") {
        const Vector3d up = axis_from_name(given, where);
        if (!trunk.isZero() && trunk.dot(up) < across)
            throw Error("the motion's rest skeleton does not stand along up = " + given, where,
                        "up means the axes of the rest skeleton (its OFFSETs); use auto");
        return up;
    }
    if (trunk.isZero())
        throw Error("the motion's rest skeleton does not tell which way is up", where, "give up, or the joint of head");
    Eigen::Index axis;
    if (trunk.cwiseAbs().maxCoeff(&axis) < aslant) return trunk;
    return (trunk[axis] < 0 ? -1.0 : 1.0) * Vector3d::Unit(axis);
}

Matrix3d find_axes(const RestSkeleton& rest, const std::string& given_up, const std::string& where) {
    const Vector3d up = find_up(rest, given_up, where);
    Vector3d left = rest.leftwards();
    left -= up * up.dot(left);
    if (!(left.norm() > 0.1))
        throw Error("the motion's rest skeleton does not tell left from right", where,
                    "give the joints of the upper legs or upper arms");
    left.normalize();
    Matrix3d axes;
    axes << left.transpose(), up.transpose(), left.cross(up).transpose();
    return axes;
}

/// Rotation that takes body bones, as the bones further in have turned them, to the motion's rest bones.
Matrix3d alignment(const RestSkeleton& body, const RestSkeleton& motion, const Matrix3d& axes, Role role) {
    const std::optional<Role> inner = limb_parent(role);
    const Matrix3d carried = inner ? alignment(body, motion, axes, *inner) : Matrix3d::Identity().eval();
    const std::optional<Vector3d> from = body.bone(role), to = motion.bone(role);
    if (!from || !to) return carried;
    return Eigen::Quaterniond::FromTwoVectors(carried * *from, axes * *to).toRotationMatrix() * carried;
}

double find_unit(const RestSkeleton& body, const RestSkeleton& motion, double given, const std::string& where) {
    if (!std::isfinite(given) || given < 0)
        throw Error("metres_per_unit is " + std::to_string(given), where, "it should be positive, or 0 to find it out");
    const double length = motion.length();
    if (given == 0) return length > 0 ? body.length() / length : 1.0;
    if (length * given < 0.1 || length * given > 10)
        throw Error("with metres_per_unit = " + std::to_string(given) + " the motion's trunk and leg are " +
                        std::to_string(length * given) + " m long",
                    where, "leave metres_per_unit out to find it out");
    return given;
}

void remark(const Body& body, MotionFit& fit) {
    char text[120];
    const Vector3d up = fit.axes.row(1), left = fit.axes.row(0);
    std::snprintf(text, sizeof text, "the motion's up is (%.2g, %.2g, %.2g), its left (%.2g, %.2g, %.2g)", up.x(),
                  up.y(), up.z(), left.x(), left.y(), left.z());
    fit.remarks.emplace_back(text);
    std::snprintf(text, sizeof text, "one unit of the motion is %.4g m", fit.metres_per_unit);
    fit.remarks.emplace_back(text);
    std::string missing;
    for (int r = 0; r < role_count; ++r)
        if (fit.role.joint[r] < 0 && body.role.joint[r] >= 0)
            missing += (missing.empty() ? "" : ", ") + std::string(role_name(static_cast<Role>(r)));
    if (!missing.empty()) fit.remarks.push_back("the motion has no joint for " + missing);
}

}  // namespace

RoleMap motion_roles(const files::Motion& motion, const MotionFitOptions& options, const std::string& where) {
    RoleMap fixed;
    for (const auto& [role, name] : options.joint) fixed[role] = named_joint(motion, name, role, where);
    std::vector<NamedJoint> joint;
    for (int j = 0; j < motion.joint_count(); ++j) joint.push_back({motion.joint_name[j], motion.joint_parent[j]});
    return detect_roles(joint, fixed);
}

MotionFit fit_motion(const Body& body, const files::Motion& motion, const MotionFitOptions& options,
                     const std::string& where) {
    MotionFit fit;
    fit.role = motion_roles(motion, options, where);
    fit.pelvis = fit.role[Role::pelvis];
    if (fit.pelvis < 0) throw Error("the motion has no joint for the role pelvis", where, "name it in the joint map");

    const RestSkeleton motion_rest = rest_of(motion, fit.role), body_rest = rest_of(body);
    fit.axes = find_axes(motion_rest, options.up, where);
    for (int r = 0; r < role_count; ++r) {
        const Role role = static_cast<Role>(r);
        if (role == Role::pelvis || fit.role[role] < 0 || body.role[role] < 0) continue;
        fit.link.push_back({body.role[role], motion_rest.source[r], alignment(body_rest, motion_rest, fit.axes, role)});
    }
    if (fit.link.empty())
        throw Error("no joint of the motion matches one of the body", where, "name them in the joint map");
    fit.metres_per_unit = find_unit(body_rest, motion_rest, options.metres_per_unit, where);
    remark(body, fit);
    return fit;
}

}  // namespace toile::skin

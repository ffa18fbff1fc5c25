#include "skin/builtin_body.h"

#include <cmath>
#include <string>

#include "cloth/error.h"
#include "skin/builtin_body_shape.h"
#include "skin/builtin_body_weights.h"
#include "skin/surface_extraction.h"
#include "skin/surface_relaxation.h"

namespace toile::skin {
namespace {

constexpr double shape_height = 1.75;  // of BuiltinShape [m]
constexpr int relaxation_rounds = 3;

void check_range(const char* key, double value, double lower, double upper) {
    if (value >= lower && value <= upper) return;
    throw Error("built-in body: " + std::string(key) + " is " + std::to_string(value) + ", must be between " +
                std::to_string(lower) + " and " + std::to_string(upper));
}

struct RoleJoint {
    Role role;
    Role parent;
    Eigen::Vector3d position;
};

void add_joint(const RoleJoint& joint, Body& body) {
    Joint added;
    added.name = std::string(role_name(joint.role));
    added.parent = joint.role == Role::pelvis ? -1 : body.role[joint.parent];
    added.bind = Eigen::Matrix4d::Identity();
    added.bind.topRightCorner<3, 1>() = joint.position;
    body.role[joint.role] = body.joint_count();
    body.joint.push_back(added);
}

/// One joint a role, in the roles' order, all with the world's axes.
void add_skeleton(const BuiltinJoints& at, Body& body) {
    const auto right = [](const Eigen::Vector3d& left) { return Eigen::Vector3d(-left.x(), left.y(), left.z()); };
    const RoleJoint joints[role_count] = {
        {Role::pelvis, Role::pelvis, at.pelvis},
        {Role::spine, Role::pelvis, at.spine},
        {Role::chest, Role::spine, at.chest},
        {Role::neck, Role::chest, at.neck},
        {Role::head, Role::neck, at.head},
        {Role::left_clavicle, Role::chest, at.clavicle},
        {Role::left_upper_arm, Role::left_clavicle, at.upper_arm},
        {Role::left_lower_arm, Role::left_upper_arm, at.lower_arm},
        {Role::left_hand, Role::left_lower_arm, at.hand},
        {Role::right_clavicle, Role::chest, right(at.clavicle)},
        {Role::right_upper_arm, Role::right_clavicle, right(at.upper_arm)},
        {Role::right_lower_arm, Role::right_upper_arm, right(at.lower_arm)},
        {Role::right_hand, Role::right_lower_arm, right(at.hand)},
        {Role::left_upper_leg, Role::pelvis, at.upper_leg},
        {Role::left_lower_leg, Role::left_upper_leg, at.lower_leg},
        {Role::left_foot, Role::left_lower_leg, at.foot},
        {Role::right_upper_leg, Role::pelvis, right(at.upper_leg)},
        {Role::right_lower_leg, Role::right_upper_leg, right(at.lower_leg)},
        {Role::right_foot, Role::right_lower_leg, right(at.foot)},
    };
    for (const RoleJoint& joint : joints) add_joint(joint, body);
}

/// Scales the body about the middle of its soles to stand `height` tall on y = 0.
void stand(double height, Body& body) {
    const double sole = body.rest_position.col(1).minCoeff(), crown = body.rest_position.col(1).maxCoeff();
    const Eigen::Vector3d floor(0.0, sole, 0.0);
    const double scale = height / (crown - sole);
    body.rest_position = scale * (body.rest_position.rowwise() - floor.transpose());
    for (Joint& joint : body.joint) {
        auto position = joint.bind.topRightCorner<3, 1>();
        position = (scale * (position - floor)).eval();
    }
}

}  // namespace

Body make_builtin_body(const BuiltinBodyOptions& options) {
    check_range("height", options.height, 1.2, 2.2);
    check_range("girth", options.girth, 0.7, 1.4);
    check_range("voxel", options.voxel, 0.008, 0.03);
    const BuiltinShape shape(options.girth);
    const double voxel = options.voxel * shape_height / options.height;
    const auto distance = [&](const Eigen::Vector3d& point) { return shape.distance(point); };
    Surface surface = extract_surface(distance, shape.lower(), shape.upper(), voxel);
    relax_surface(distance, relaxation_rounds, surface);
    const BuiltinJoints joints = builtin_joints(options.girth);
    Body body;
    body.triangle = surface.triangle;
    body.rest_position = surface.position;
    body.weight = builtin_weights(surface, joints, options.girth);
    add_skeleton(joints, body);
    stand(options.height, body);
    check_body(body, "the built-in body");
    return body;
}

}  // namespace toile::skin

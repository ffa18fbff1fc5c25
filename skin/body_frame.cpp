#include "skin/body_frame.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "cloth/error.h"

namespace toile::skin {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double shortest = 0.5, tallest = 2.5, usual = 1.7;  // [m]

std::string digits(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

Vector3d axis_of(const std::string& up, const std::string& where) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name(1, "xyz"[axis]);
        if (up == name || up == "+" + name) return Vector3d::Unit(axis);
        if (up == "-" + name) return -Vector3d::Unit(axis);
    }
    throw Error("'" + up + "' is no up axis", where, "use auto, x, y, z, -x, -y or -z");
}

std::string name_of(const Vector3d& axis) {
    for (int i = 0; i < 3; ++i)
        if (std::abs(axis[i]) > 0.5) return std::string(axis[i] < 0 ? "-" : "+") + "xyz"[i];
    return "?";
}

/// All 24 ways to turn axes into axes.
std::vector<Matrix3d> axis_rotations() {
    std::vector<Matrix3d> all;
    for (int left = 0; left < 6; ++left) {
        for (int up = 0; up < 6; ++up) {
            if (left / 2 == up / 2) continue;
            const Vector3d x = Vector3d::Unit(left / 2) * (left % 2 ? -1 : 1);
            const Vector3d y = Vector3d::Unit(up / 2) * (up % 2 ? -1 : 1);
            Matrix3d rotation;
            rotation << x.transpose(), y.transpose(), x.cross(y).transpose();
            all.push_back(rotation);
        }
    }
    return all;
}

/// What the joints of known role say about the body, in bind space.
struct Stance {
    const BindSkeleton& skeleton;
    const RoleMap& role;

    std::optional<Vector3d> at(Role which) const {
        if (role[which] < 0) return std::nullopt;
        return Vector3d(skeleton.joint[role[which]].bind.translation());
    }
    std::optional<Vector3d> between(Role left, Role right) const {
        const auto a = at(left), b = at(right);
        if (!a || !b) return std::nullopt;
        return Vector3d(0.5 * (*a + *b));
    }

    /// From the lowest to the highest known part of head, trunk and legs.
    std::optional<Vector3d> up() const {
        std::optional<Vector3d> low, high;
        for (const auto& part :
             {between(Role::left_foot, Role::right_foot), between(Role::left_lower_leg, Role::right_lower_leg),
              between(Role::left_upper_leg, Role::right_upper_leg), at(Role::pelvis)})
            if (part && !low) low = part;
        for (const auto& part : {at(Role::head), at(Role::neck), between(Role::left_upper_arm, Role::right_upper_arm),
                                 at(Role::chest), at(Role::spine)})
            if (part && !high) high = part;
        if (!low || !high || !((*high - *low).norm() > 1e-9)) return std::nullopt;
        return (*high - *low).normalized();
    }

    /// From the right to the left limbs, all known pairs together.
    std::optional<Vector3d> left() const {
        Vector3d sum = Vector3d::Zero();
        for (const auto& [a, b] : {std::pair{Role::left_upper_arm, Role::right_upper_arm},
                                   std::pair{Role::left_upper_leg, Role::right_upper_leg},
                                   std::pair{Role::left_lower_arm, Role::right_lower_arm},
                                   std::pair{Role::left_clavicle, Role::right_clavicle}}) {
            const auto l = at(a), r = at(b);
            if (l && r) sum += *l - *r;
        }
        if (!(sum.norm() > 1e-9)) return std::nullopt;
        return sum.normalized();
    }
};

/// Turns the file's up axis to y, keeping x; -y of a z-up file becomes the front.
Matrix3d upright(const Vector3d& up) {
    if (up.y() > 0.5) return Matrix3d::Identity();
    Matrix3d rotation;
    if (std::abs(up.x()) > 0.5)
        rotation << Vector3d(0, -up.x(), 0).transpose(), up.transpose(), Vector3d(0, 0, 1).transpose();
    else
        rotation << Vector3d(1, 0, 0).transpose(), up.transpose(), Vector3d(1, 0, 0).cross(up).transpose();
    return rotation;
}

/// The rotation of axes nearest to `rotation`, among those that keep `fixed_up` up where it is given.
Matrix3d nearest_axes(const Matrix3d& rotation, const std::optional<Vector3d>& fixed_up) {
    Matrix3d best = Matrix3d::Identity();
    double most = -1e300;
    for (const Matrix3d& candidate : axis_rotations()) {
        if (fixed_up && (candidate.row(1).transpose() - *fixed_up).norm() > 0.5) continue;
        // A hair in favour of no change keeps ties from falling with rounding.
        const double agreement = (candidate.cwiseProduct(rotation)).sum() + (candidate.isIdentity() ? 1e-6 : 0);
        if (agreement > most) {
            most = agreement;
            best = candidate;
        }
    }
    return best;
}

Matrix3d find_rotation(const files::RiggedFile& file, const BindSkeleton& skeleton, const Stance& stance,
                       const std::optional<Vector3d>& given_up, const std::string& where, BodyFrame& frame) {
    Vector3d up = given_up ? *given_up : stance.up().value_or(Vector3d::Zero());
    const std::optional<Vector3d> left = stance.left();
    const Matrix3d scene =
        upright(axis_of(file.up, where)) * skeleton.scene.linear() / std::cbrt(skeleton.scene.linear().determinant());
    if (up.isZero() || !left) {
        frame.remarks.push_back("too few joints have a known role: the file's own axes tell where the body faces");
        return nearest_axes(given_up ? upright(*given_up) : scene, given_up);
    }
    const Vector3d across = (*left - up * up.dot(*left)).normalized();
    Matrix3d measured;
    measured << across.transpose(), up.transpose(), across.cross(up).transpose();
    const Matrix3d rotation = nearest_axes(measured, given_up);
    const double tilt = std::acos(std::clamp(rotation.row(1).dot(stance.up().value_or(up)), -1.0, 1.0));
    if (tilt > 0.5)
        frame.remarks.push_back("in its bind pose the body leans " + digits(tilt * 180 / M_PI) + " degrees from " +
                                name_of(rotation.row(1).transpose()));
    if (!rotation.isIdentity())
        frame.remarks.push_back("the body was turned: " + name_of(rotation.row(1).transpose()) +
                                " of the file is up, " + name_of(rotation.row(2).transpose()) + " is ahead");
    return rotation;
}

bool human(double height) {
    return height >= shortest && height <= tallest;
}

double estimated_unit(double height, const std::string& where) {
    double best = 0;
    for (const double unit : {1.0, 0.1, 0.01, 0.001, 1e-4, 1e-5, 10.0, 100.0, 1000.0, 0.0254, 0.3048}) {
        if (!human(height * unit)) continue;
        if (best == 0 || std::abs(std::log(height * unit / usual)) < std::abs(std::log(height * best / usual)))
            best = unit;
    }
    if (best == 0)
        throw Error("the body is " + digits(height) + " units tall: no usual unit makes that a person", where,
                    "give metres_per_unit");
    return best;
}

double find_unit(const files::RiggedFile& file, const BindSkeleton& skeleton, double height, const std::string& where,
                 BodyFrame& frame) {
    const double in_scene = std::cbrt(std::abs(skeleton.scene.linear().determinant()));
    for (const double stated : {file.metres_per_unit * in_scene, file.metres_per_unit}) {
        // A unit that is a float's rounding away from a round one is the round one.
        double unit = stated;
        for (const double round : {1.0, 0.1, 0.01, 0.001, 0.0254, 0.3048})
            if (std::abs(stated / round - 1) < 1e-5) unit = round;
        if (!human(height * unit)) continue;
        if (unit != 1) frame.remarks.push_back("the file's unit is " + digits(unit) + " m");
        return unit;
    }
    const double unit = estimated_unit(height, where);
    frame.remarks.push_back("the body is " + digits(height) + " units tall: its unit was taken to be " + digits(unit) +
                            " m");
    return unit;
}

}  // namespace

BodyFrame body_frame(const files::RiggedFile& file, const BindSkeleton& skeleton, const RoleMap& role_joint,
                     const Positions& position, const std::string& up, double metres_per_unit,
                     const std::string& where) {
    BodyFrame frame;
    std::optional<Vector3d> given_up;
    if (up != "auto") given_up = axis_of(up, where);
    frame.rotation = find_rotation(file, skeleton, {skeleton, role_joint}, given_up, where, frame);
    if (metres_per_unit < 0 || !std::isfinite(metres_per_unit))
        throw Error("metres_per_unit is " + digits(metres_per_unit), where,
                    "give a length above 0, or 0 to find it out");
    const Eigen::VectorXd elevation = position * frame.rotation.row(1).transpose();
    const double height = elevation.maxCoeff() - elevation.minCoeff();
    if (!(height > 0)) throw Error("the body has no height", where);
    frame.metres_per_unit = metres_per_unit > 0 ? metres_per_unit : find_unit(file, skeleton, height, where, frame);
    return frame;
}

}  // namespace toile::skin

#include "pattern/body_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::pattern {
namespace {

using skin::Body;
using skin::Role;

constexpr std::array<Role, 2> upper_arm = {Role::left_upper_arm, Role::right_upper_arm};
constexpr std::array<Role, 2> lower_arm = {Role::left_lower_arm, Role::right_lower_arm};
constexpr std::array<Role, 2> hand = {Role::left_hand, Role::right_hand};
constexpr std::array<Role, 2> upper_leg = {Role::left_upper_leg, Role::right_upper_leg};

Eigen::Vector3d joint_position(const Body& body, Role role) {
    return body.joint[body.role[role]].bind.block<3, 1>(0, 3);
}

void require_roles(const Body& body) {
    std::string missing;
    for (Role role : {Role::pelvis, Role::neck, Role::left_upper_arm, Role::left_lower_arm, Role::right_upper_arm,
                      Role::right_lower_arm})
        if (body.role[role] < 0) missing += (missing.empty() ? "" : ", ") + std::string(skin::role_name(role));
    if (!missing.empty())
        throw Error("the T-shirt cannot be cut: the body has no joint for " + missing, {},
                    "name the joints in the body's role map");
}

/// Weight of each vertex on a joint and all below it.
Eigen::VectorXd weight_below(const Body& body, int top) {
    std::vector<bool> below(body.joint.size(), false);
    for (int j = 0; j < body.joint_count(); ++j)
        below[j] = j == top || (body.joint[j].parent >= 0 && below[body.joint[j].parent]);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(body.vertex_count());
    for (int v = 0; v < body.vertex_count(); ++v)
        for (int w = body.weight.offset[v]; w < body.weight.offset[v + 1]; ++w)
            if (below[body.weight.joint[w]]) weight[v] += body.weight.value[w];
    return weight;
}

Triangles triangles_of(const Body& body, const std::vector<int>& vertex_part, int part) {
    Triangles rows(body.triangle.rows(), 3);
    int count = 0;
    for (int f = 0; f < body.triangle.rows(); ++f) {
        bool all = true;
        for (int k = 0; k < 3; ++k) all = all && vertex_part[body.triangle(f, k)] == part;
        if (all) rows.row(count++) = body.triangle.row(f);
    }
    rows.conservativeResize(count, 3);
    return rows;
}

BodyParts split(const Body& body) {
    std::vector<int> part(static_cast<size_t>(body.vertex_count()), 0);
    auto assign = [&](Role role, int number) {
        const Eigen::VectorXd weight = weight_below(body, body.role[role]);
        for (int v = 0; v < body.vertex_count(); ++v)
            if (weight[v] >= 0.5) part[v] = number;
    };
    for (int side = 0; side < 2; ++side) assign(upper_arm[side], 1 + side);
    if (body.role[Role::head] >= 0) assign(Role::head, 3);
    std::vector<int> head(part.size());
    std::transform(part.begin(), part.end(), head.begin(), [](int number) { return number == 3; });
    return {triangles_of(body, part, 0),
            {triangles_of(body, part, 1), triangles_of(body, part, 2)},
            triangles_of(body, head, 0)};
}

/// Calls `look(point, normal)` for points of the surface within `reach` of `center`, closer together than `spacing`.
template <typename Look>
void sample_surface(const Body& body, const Positions& normal, const Eigen::RowVector3d& center, double reach,
                    double spacing, const Look& look) {
    for (int f = 0; f < body.triangle.rows(); ++f) {
        const auto t = body.triangle.row(f);
        double longest = 0.0;
        for (int k = 0; k < 3; ++k)
            longest = std::max(longest, (body.rest_position.row(t[k]) - body.rest_position.row(t[(k + 1) % 3])).norm());
        if ((body.rest_position.row(t[0]) - center).norm() > reach + longest) continue;
        const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, 40);
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; i + j <= n; ++j) {
                const double a = 1.0 * i / n, b = 1.0 * j / n, c = 1.0 - a - b;
                const auto mean = [&](const Positions& at) {
                    return Eigen::Vector3d(a * at.row(t[0]) + b * at.row(t[1]) + c * at.row(t[2]));
                };
                look(mean(body.rest_position), mean(normal).normalized());
            }
        }
    }
}

/// Where the trunk's flank and the arm's underside meet: the point deepest in the notch among the surface that faces
/// out of it, in the frontal planes around the shoulder joint; of these the lowest, as the folds at front and back
/// hang lower than the hollow.
void find_notch(const Body& body, const Positions& normal, ArmMeasure& arm) {
    const Eigen::Vector3d along = (arm.elbow - arm.shoulder).normalized();
    Eigen::Vector3d out = Eigen::Vector3d(along.x(), along.y() - 1.0, 0.0);
    if (out.norm() < 0.2) out = {std::copysign(0.2, along.x()), -1.0, 0.0};
    out.normalize();
    const double reach = 0.8 * (arm.elbow - arm.shoulder).norm();
    constexpr int planes = 7;
    constexpr double thickness = 0.015;
    std::array<double, planes> depth;
    depth.fill(std::numeric_limits<double>::infinity());
    std::array<Eigen::Vector3d, planes> apex;
    sample_surface(body, normal, arm.shoulder.transpose(), reach, thickness,
                   [&](const Eigen::Vector3d& point, const Eigen::Vector3d& facing) {
                       const Eigen::Vector3d p = point - arm.shoulder;
                       const int plane = static_cast<int>(std::floor(p.z() / thickness + 0.5 * planes));
                       if (plane < 0 || plane >= planes || p.norm() > reach || facing.dot(out) < 0.3) return;
                       if (p.dot(out) < 0.0 || p.dot(out) >= depth[plane]) return;
                       depth[plane] = p.dot(out);
                       apex[plane] = point;
                   });
    double lowest = -1.0;
    for (int plane = 0; plane < planes; ++plane) {
        if (!std::isfinite(depth[plane]) || depth[plane] <= lowest) continue;
        lowest = depth[plane];
        arm.notch = apex[plane];
    }
    if (lowest < 0.0)
        throw Error("the T-shirt cannot be cut: no armpit was found below a shoulder joint", {},
                    "the body's neutral pose needs arms off the trunk (an A or a T pose)");
    arm.notch_direction = out;
}

void measure_sections(const Body& body, const Triangles& surface, ArmMeasure& arm) {
    const double upper = (arm.elbow - arm.shoulder).norm(), lower = (arm.wrist - arm.elbow).norm();
    for (double station = 0.3 * upper; station < upper + 0.9 * lower; station += 0.02) {
        const bool above = station <= upper;
        const Eigen::Vector3d from = above ? arm.shoulder : arm.elbow, to = above ? arm.elbow : arm.wrist;
        const Eigen::Vector3d along = (to - from).normalized();
        const Eigen::Vector3d origin = from + (station - (above ? 0.0 : upper)) * along;
        const Eigen::Vector3d across = along.unitOrthogonal(), third = along.cross(across);
        std::vector<Eigen::Vector2d> points;
        for (const Eigen::Vector3d& p : plane_section(surface, body.rest_position, origin, along))
            if ((p - origin).norm() < 0.5 * upper)
                points.emplace_back((p - origin).dot(across), (p - origin).dot(third));
        const TapeLoop tape(points, 0.0);
        if (tape.length() <= 0.0) continue;
        Eigen::Vector2d center = Eigen::Vector2d::Zero();
        for (int k = 0; k < 64; ++k) center += tape.at(tape.length() * k / 64) / 64;
        arm.station.push_back(station);
        arm.center.emplace_back(origin + center.x() * across + center.y() * third);
        arm.tape.push_back(tape.length());
        if (station > 0.35 * upper && station < 0.85 * upper)
            arm.circumference = std::max(arm.circumference, tape.length());
    }
    if (arm.circumference <= 0.0)
        throw Error("the T-shirt cannot be cut: an upper arm has no section (do its skin weights follow its joint?)");
}

ArmMeasure measure_arm(const Body& body, const Triangles& surface, const Positions& normal, int side) {
    ArmMeasure arm;
    arm.shoulder = joint_position(body, upper_arm[side]);
    arm.elbow = joint_position(body, lower_arm[side]);
    arm.wrist =
        body.role[hand[side]] >= 0 ? joint_position(body, hand[side]) : Eigen::Vector3d(2.0 * arm.elbow - arm.shoulder);
    find_notch(body, normal, arm);
    measure_sections(body, surface, arm);
    return arm;
}

double neck_half_width(const Body& body, const BodyMeasure& measure) {
    double narrowest = std::numeric_limits<double>::infinity();
    const double below = measure.neck_height - measure.underarm_height;
    for (double height = measure.neck_height - 0.1 * below; height < measure.neck_height + 0.4 * below;
         height += 0.005) {
        double width = 0.0;
        for (const Eigen::Vector2d& p : trunk_section(body, measure.part, height))
            width = std::max(width, std::abs(p.x() - measure.center_x));
        if (width > 0.0) narrowest = std::min(narrowest, width);
    }
    if (!std::isfinite(narrowest)) throw Error("the T-shirt cannot be cut: the body has no section at its neck joint");
    return std::min(narrowest, 0.55 * measure.shoulder_half_width);
}

}  // namespace

std::vector<Eigen::Vector2d> trunk_section(const Body& body, const BodyParts& part, double height) {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& p : plane_section(part.trunk, body.rest_position, {0.0, height, 0.0}, {0.0, 1.0, 0.0}))
        points.emplace_back(p.x(), p.z());
    return points;
}

BodyMeasure measure_body(const Body& body) {
    require_roles(body);
    BodyMeasure measure;
    measure.part = split(body);
    const Positions normal = vertex_normals(body.triangle, body.rest_position);
    for (int side = 0; side < 2; ++side) measure.arm[side] = measure_arm(body, measure.part.arm[side], normal, side);
    const ArmMeasure &left = measure.arm[0], &right = measure.arm[1];
    if (!(left.shoulder.x() > right.shoulder.x()))
        throw Error("the T-shirt cannot be cut: the left shoulder is not at the body's left (+x)", {},
                    "check the role map and the body's facing (+z)");
    measure.center_x = 0.5 * (left.shoulder.x() + right.shoulder.x());
    measure.center_z = 0.5 * (left.shoulder.z() + right.shoulder.z());
    measure.shoulder_half_width = 0.5 * (left.shoulder.x() - right.shoulder.x());
    measure.underarm_height = std::min(left.notch.y(), right.notch.y());
    measure.neck_height = joint_position(body, Role::neck).y();
    measure.hip_height = joint_position(body, Role::pelvis).y();
    if (body.role[upper_leg[0]] >= 0 && body.role[upper_leg[1]] >= 0)
        measure.hip_height = 0.5 * (joint_position(body, upper_leg[0]).y() + joint_position(body, upper_leg[1]).y());
    if (!(measure.hip_height < measure.underarm_height && measure.underarm_height < measure.neck_height))
        throw Error("the T-shirt cannot be cut: hip, armpit and neck do not lie above each other (y up)");
    measure.neck_half_width = neck_half_width(body, measure);
    const double trunk = measure.underarm_height - measure.hip_height;
    for (double height = measure.underarm_height - 0.45 * trunk; height < measure.underarm_height; height += 0.01)
        measure.chest = std::max(measure.chest, TapeLoop(trunk_section(body, measure.part, height), 0.0).length());
    if (measure.chest <= 0.0) throw Error("the T-shirt cannot be cut: the trunk has no section below the arms");
    return measure;
}

}  // namespace toile::pattern

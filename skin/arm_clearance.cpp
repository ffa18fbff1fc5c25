#include "skin/arm_clearance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "cloth/topology.h"
#include "skin/surface_query.h"

namespace toile::skin {
namespace {

/// What stands nearer to the trunk than this in the bind pose belongs to the armpit [m]; what stands further off may
/// come nearer to this share of it.
constexpr double armpit_reach = 0.03, least_share = 1.0 / 7.0;
/// An arm is turned by no more than this at a time [rad], and turned anew at most so often.
constexpr double largest_step = 0.05;
constexpr int most_steps = 40;
/// A little more than is asked for, so that the last step arrives [m].
constexpr double margin = 5e-4;

/// The joint's rotation after `turn` of the world, everything above it staying.
Eigen::RowVector3d turned(const Body& body, const Pose& pose, int joint, const Eigen::AngleAxisd& turn) {
    const Eigen::Vector3d theta = pose.row(joint).transpose();
    const double angle = theta.norm();
    const Eigen::Quaterniond own(angle > 0.0 ? Eigen::AngleAxisd(angle, theta / angle)
                                             : Eigen::AngleAxisd(0.0, Eigen::Vector3d::UnitX()));
    const Eigen::Matrix3d world = forward_kinematics(body, pose)[joint].topLeftCorner<3, 3>();
    const Eigen::Matrix3d before = world * own.toRotationMatrix().transpose();
    const Eigen::AngleAxisd after(Eigen::Quaterniond(before.transpose() * turn.toRotationMatrix() * world));
    return (after.angle() * after.axis()).transpose();
}

}  // namespace

ArmClearance::ArmClearance(const Body& body, SkinningMethod method, double gap) : body_(body), method_(method) {
    std::vector<int> heaviest(static_cast<size_t>(body.vertex_count()));
    for (int v = 0; v < body.vertex_count(); ++v) heaviest[v] = heaviest_joint(body.weight, v);
    std::vector<bool> elsewhere(static_cast<size_t>(body.joint_count()), false);  // neither trunk nor leg
    for (const Role role : {Role::left_upper_arm, Role::right_upper_arm, Role::neck, Role::head}) {
        if (body.role[role] < 0) continue;
        const std::vector<bool> below = joints_below(body, body.role[role]);
        for (size_t j = 0; j < below.size(); ++j) elsewhere[j] = elsewhere[j] || below[j];
    }
    std::vector<int> kept;
    for (int f = 0; f < body.triangle.rows(); ++f)
        if (!elsewhere[heaviest[body.triangle(f, 0)]] && !elsewhere[heaviest[body.triangle(f, 1)]] &&
            !elsewhere[heaviest[body.triangle(f, 2)]])
            kept.push_back(f);
    if (kept.empty()) return;
    trunk_ = body.triangle(kept, Eigen::all);
    // Beside the cuts at shoulders and neck the nearest point may have its normal any way.
    std::vector<bool> on_cut(static_cast<size_t>(body.vertex_count()), false);
    for (const std::vector<int>& loop : boundary_loops(trunk_))
        for (const int v : loop) on_cut[v] = true;
    for (int f = 0; f < trunk_.rows(); ++f)
        rim_.push_back(on_cut[trunk_(f, 0)] || on_cut[trunk_(f, 1)] || on_cut[trunk_(f, 2)]);
    const SurfaceQuery query(trunk_, body.rest_position);
    for (const Role role : {Role::left_upper_arm, Role::right_upper_arm}) {
        if (body.role[role] < 0) continue;
        Arm arm{body.role[role], {}};
        const std::vector<bool> below = joints_below(body, arm.joint);
        for (int v = 0; v < body.vertex_count(); ++v) {
            if (!below[heaviest[v]]) continue;
            const double off = query.nearest(body.rest_position.row(v).transpose()).distance;
            if (off > armpit_reach) arm.kept.push_back({v, std::min(gap, least_share * off)});
        }
        if (!arm.kept.empty()) arm_.push_back(std::move(arm));
    }
}

Pose ArmClearance::clear(const Pose& pose) const {
    Pose cleared = pose;
    for (const Arm& arm : arm_) {
        Pose next = cleared;
        if (turn_away(arm, next)) cleared = next;
    }
    return cleared;
}

bool ArmClearance::turn_away(const Arm& arm, Pose& pose) const {
    const Pose start = pose;
    for (int step = 0; step < most_steps; ++step) {
        const Positions x = skin_positions(body_, pose, method_);
        const SurfaceQuery trunk(trunk_, x);
        const Eigen::Vector3d shoulder = forward_kinematics(body_, pose)[arm.joint].topRightCorner<3, 1>();
        // All that are too near say which way to turn, by what they lack; the worst says how far.
        Eigen::Vector3d axis = Eigen::Vector3d::Zero();
        double worst = 0.0, lever = 0.0;
        for (const auto& [vertex, gap] : arm.kept) {
            const Eigen::Vector3d p = x.row(vertex).transpose();
            const SurfaceQuery::Nearest near = trunk.nearest(p);
            const double lack = gap + margin - near.signed_distance;
            if (!(lack > 0.0) || !(near.distance > 0.0) || rim_[near.triangle]) continue;
            const Eigen::Vector3d out = (p - near.position) / near.signed_distance;
            const Eigen::Vector3d turning = (p - shoulder).cross(out);
            axis += lack * turning;
            if (lack > worst) {
                worst = lack;
                lever = turning.norm();
            }
        }
        if (!(worst > margin)) return true;
        if (!(axis.norm() > 0.0) || !(lever > 0.0)) return false;
        const double angle = std::min(largest_step, worst / lever);
        pose.row(arm.joint) = turned(body_, pose, arm.joint, Eigen::AngleAxisd(angle, axis.normalized()));
        if (largest_joint_rotation(start, pose) > largest_turn) return false;
    }
    return false;
}

ClearedPoses::ClearedPoses(std::unique_ptr<PoseSource> source, const Body& body, SkinningMethod method, double gap)
    : source_(std::move(source)), body_(body), clearance_(body_, method, gap) {}

}  // namespace toile::skin

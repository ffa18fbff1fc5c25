#include "simulate/ladder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulate/drape.h"

namespace toile::simulate {
namespace {

/// No rung makes level sets finer than this [m].
constexpr double finest_voxel = 0.002;

/// How far through the gate a status is: the later the reason, the more was right.
int rank(DrapeStatus status) {
    constexpr std::array order{DrapeStatus::not_finite,      DrapeStatus::not_at_rest,   DrapeStatus::penetrates_body,
                               DrapeStatus::self_intersects, DrapeStatus::overstretched, DrapeStatus::accepted};
    return static_cast<int>(std::find(order.begin(), order.end(), status) - order.begin());
}

/// Whether a joint is one of `roles` or hangs below one.
std::vector<bool> below(const skin::Body& body, const std::vector<skin::Role>& roles) {
    std::vector<bool> found(static_cast<size_t>(body.joint_count()), false);
    for (const skin::Role role : roles)
        if (body.role[role] >= 0) found[body.role[role]] = true;
    for (int j = 0; j < body.joint_count(); ++j)
        if (body.joint[j].parent >= 0 && found[body.joint[j].parent]) found[j] = true;
    return found;
}

/// `pose` with some joints as in the neutral pose.
skin::Pose without(skin::Pose pose, const std::vector<bool>& joint) {
    for (size_t j = 0; j < joint.size(); ++j)
        if (joint[j]) pose.row(static_cast<Eigen::Index>(j)).setZero();
    return pose;
}

}  // namespace

std::string_view rung_name(int rung) {
    constexpr std::array<std::string_view, rung_count> name{"as configured", "smaller steps", "longer path",
                                                            "other start"};
    return name[static_cast<size_t>(rung)];
}

DrapeScene rung_scene(const DrapeScene& scene, int rung) {
    DrapeScene changed = scene;
    if (rung >= 1) {
        changed.schedule.joint_step *= 0.5;
        changed.solver.time_step *= 0.5;
        changed.schedule.path_iterations *= 2;
        changed.level_set.voxel = std::max(0.5 * scene.level_set.voxel, std::min(scene.level_set.voxel, finest_voxel));
    }
    if (rung >= 3) {
        changed.solver.damping = std::max(10.0 * scene.solver.damping, 1.0);
        changed.solver.max_iterations *= 2;
        changed.solver.stall_iterations *= 2;
    }
    return changed;
}

std::vector<skin::Pose> rung_path(const skin::Body& body, const skin::Pose& pose, int rung) {
    using skin::Role;
    std::vector<skin::Pose> path;
    const auto add = [&](const skin::Pose& next) {
        if (path.empty() ? !next.isZero(0.0) : next != path.back()) path.push_back(next);
    };
    if (rung >= 2) {
        const std::vector<Role> limbs{Role::left_clavicle,  Role::left_upper_arm,  Role::left_upper_leg,
                                      Role::right_clavicle, Role::right_upper_arm, Role::right_upper_leg};
        const std::vector<Role> ends{Role::left_lower_arm, Role::left_lower_leg, Role::right_lower_arm,
                                     Role::right_lower_leg};
        add(without(pose, below(body, limbs)));
        add(without(pose, below(body, ends)));
    }
    add(pose);
    if (path.empty()) path.push_back(pose);
    return path;
}

std::vector<int> rungs(const LadderOptions& options, bool with_path) {
    std::vector<int> chosen{0};
    for (int rung = 1; rung < rung_count && static_cast<int>(chosen.size()) <= options.tries; ++rung)
        if (rung != 2 || with_path) chosen.push_back(rung);
    return chosen;
}

bool better(const DrapeResult& one, const DrapeResult& other) {
    const int a = rank(one.status), b = rank(other.status);
    if (a != b) return a > b;
    return one.certificate.residual_force < other.certificate.residual_force;
}

}  // namespace toile::simulate

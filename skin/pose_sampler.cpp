#include "skin/pose_sampler.h"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <random>

#include "cloth/error.h"

namespace toile::skin {
namespace {

bool is_right(Role role) {
    return role_name(role).starts_with("right_");
}

/// The limb on the other side, or the role itself in the middle of the body.
Role mirrored(Role role) {
    const std::string name(role_name(role));
    if (name.starts_with("right_")) return role_from_name("left_" + name.substr(6));
    if (name.starts_with("left_")) return role_from_name("right_" + name.substr(5));
    return role;
}

void check_roles(const Body& body, const SamplerOptions& options, const std::string& where) {
    if (options.roles.empty()) throw Error("no joint is chosen to move", where, "list one role at least");
    for (std::size_t i = 0; i < options.roles.size(); ++i) {
        const std::string name(role_name(options.roles[i]));
        if (std::count(options.roles.begin(), options.roles.end(), options.roles[i]) > 1)
            throw Error("the role " + name + " is listed twice", where);
        if (body.role[options.roles[i]] < 0)
            throw Error("the body has no joint for the role " + name, where, "name its joint in the role map");
    }
    for (const auto& [role, limit] : options.limits) {
        if (std::find(options.roles.begin(), options.roles.end(), role) == options.roles.end())
            throw Error("limits are given for the role " + std::string(role_name(role)) + ", which does not move",
                        where, "add it to the roles that move");
        check_limit(role, limit, where);
    }
}

}  // namespace

PoseSampler::PoseSampler(const Body& body, const SamplerOptions& options, const std::string& where)
    : symmetric_(options.symmetric) {
    check_roles(body, options, where);
    skeleton_.joint = body.joint;
    skeleton_.role = body.role;
    std::mt19937_64 shift(options.seed);
    for (const Role role : options.roles) {
        const bool middle = symmetric_ && mirrored(role) == role;
        const bool copied =
            symmetric_ && is_right(role) &&
            std::find(options.roles.begin(), options.roles.end(), mirrored(role)) != options.roles.end();
        const auto given = options.limits.find(role);
        const JointLimit limit = given == options.limits.end() ? default_limit(role) : given->second;
        fixed_.angle[role] = limit.lower;
        for (int axis = 0; axis < 3; ++axis) {
            // Each axis draws its shift even where it is fixed, so that fixing one leaves the shifts of the others.
            const std::uint64_t word = shift();
            if (!copied && !(middle && axis != 1) && limit.lower[axis] < limit.upper[axis])
                axis_.push_back({role, axis, limit.lower[axis], limit.upper[axis], word});
        }
    }
}

RoleAngles PoseSampler::angles(std::int64_t k) const {
    if (k < 0) throw Error("there is no pose number " + std::to_string(k), {}, "pose numbers start at 0");
    RoleAngles sample = fixed_;
    if (!axis_.empty()) {
        boost::random::sobol sequence(axis_.size());
        sequence.seed(static_cast<std::uint64_t>(k));
        for (const Axis& axis : axis_) {
            // The upper 53 bits make a double in [0, 1) exactly.
            const double share = static_cast<double>((sequence() ^ axis.shift) >> 11) * 0x1p-53;
            sample.angle[axis.role][axis.axis] = axis.lower + share * (axis.upper - axis.lower);
        }
    }
    if (!symmetric_) return sample;
    for (auto& [role, angle] : sample.angle) {
        if (mirrored(role) == role) angle[0] = angle[2] = 0;
        if (is_right(role) && sample.angle.count(mirrored(role))) angle = sample.angle[mirrored(role)];
    }
    return sample;
}

Pose PoseSampler::pose(std::int64_t k) const {
    return pose_from_angles(skeleton_, angles(k));
}

}  // namespace toile::skin

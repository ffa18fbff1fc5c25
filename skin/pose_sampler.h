#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "skin/anatomy.h"
#include "skin/body.h"
#include "skin/pose.h"

namespace toile::skin {

struct SamplerOptions {
    std::uint64_t seed = 0;
    /// The roles that move; all others keep the bind pose.
    std::vector<Role> roles = {Role::left_upper_arm, Role::right_upper_arm, Role::left_lower_arm, Role::right_lower_arm,
                               Role::spine};
    /// Limits [rad] that replace `default_limit` for a role in `roles`; lower = upper fixes an angle.
    std::map<Role, JointLimit> limits;
    /// Right limbs copy the angles of left ones and the trunk stays in the middle: the posture is its own mirror image.
    bool symmetric = false;
};

/// Poses that fill the box of joint limits evenly: a Sobol sequence (Bratley and Fox 1988) over all angles that may
/// vary, shifted digitally by a seeded random word in each dimension, so that every seed gives another set, equally
/// even. Sample k depends on the options and k alone, and costs the same for every k.
class PoseSampler {
  public:
    /// Throws Error naming role and axis for limits that are reversed, not finite or beyond a whole turn; naming the
    /// role for one that the body lacks, that is listed twice, or whose limits are given although it does not move;
    /// and where no role is listed at all. `where` is the configuration's file and key.
    PoseSampler(const Body& body, const SamplerOptions& options, const std::string& where = {});

    RoleAngles angles(std::int64_t k) const;  ///< anatomical angles of sample k >= 0
    Pose pose(std::int64_t k) const;

  private:
    struct Axis {
        Role role;
        int axis;             ///< 0 raise, 1 swing, 2 twist
        double lower, upper;  ///< [rad]
        std::uint64_t shift;  ///< what the Sobol word is xor-ed with
    };

    Body skeleton_;  ///< joints and roles alone, without the surface
    bool symmetric_;
    std::vector<Axis> axis_;
    RoleAngles fixed_;  ///< angles that do not vary
};

}  // namespace toile::skin

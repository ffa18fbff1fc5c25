#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace toile::skin {

/// What a joint does in a humanoid, independent of the names of one rig. Left is the body's own left (+x when it faces
/// +z).
enum class Role {
    pelvis,
    spine,
    chest,
    neck,
    head,
    left_clavicle,
    left_upper_arm,
    left_lower_arm,
    left_hand,
    right_clavicle,
    right_upper_arm,
    right_lower_arm,
    right_hand,
    left_upper_leg,
    left_lower_leg,
    left_foot,
    right_upper_leg,
    right_lower_leg,
    right_foot,
};
inline constexpr int role_count = 19;

std::string_view role_name(Role role);         ///< the word used in configurations: "left_upper_arm"
Role role_from_name(const std::string& name);  ///< throws Error that lists the roles

/// Joint index of each role, -1 where the body has none.
struct RoleMap {
    std::array<int, role_count> joint;
    RoleMap() { joint.fill(-1); }
    int operator[](Role role) const { return joint[static_cast<int>(role)]; }
    int& operator[](Role role) { return joint[static_cast<int>(role)]; }
    std::vector<Role> missing() const;
};

}  // namespace toile::skin

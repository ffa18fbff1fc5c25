#include "skin/role.h"

#include "cloth/error.h"

namespace toile::skin {
namespace {

constexpr std::array<std::string_view, role_count> names = {
    "pelvis",          "spine",           "chest",           "neck",           "head",
    "left_clavicle",   "left_upper_arm",  "left_lower_arm",  "left_hand",      "right_clavicle",
    "right_upper_arm", "right_lower_arm", "right_hand",      "left_upper_leg", "left_lower_leg",
    "left_foot",       "right_upper_leg", "right_lower_leg", "right_foot"};

}  // namespace

std::string_view role_name(Role role) {
    return names[static_cast<size_t>(role)];
}

Role role_from_name(const std::string& name) {
    std::string all;
    for (int i = 0; i < role_count; ++i) {
        if (names[i] == name) return static_cast<Role>(i);
        all += (i ? ", " : "") + std::string(names[i]);
    }
    throw Error("there is no joint role '" + name + "'", {}, "the roles are " + all);
}

std::vector<Role> RoleMap::missing() const {
    std::vector<Role> absent;
    for (int i = 0; i < role_count; ++i)
        if (joint[i] < 0) absent.push_back(static_cast<Role>(i));
    return absent;
}

}  // namespace toile::skin

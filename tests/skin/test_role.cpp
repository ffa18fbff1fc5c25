#include <gmock/gmock.h>

#include "cloth/error.h"
#include "skin/role.h"

namespace toile::skin {
namespace {

TEST(Role, NamesAndRolesMatch) {
    for (int i = 0; i < role_count; ++i) {
        const Role role = static_cast<Role>(i);
        EXPECT_EQ(role_from_name(std::string(role_name(role))), role);
    }
    EXPECT_EQ(role_name(Role::left_upper_arm), "left_upper_arm");
    EXPECT_EQ(role_name(Role::right_foot), "right_foot");
}

TEST(Role, UnknownNameListsTheRoles) {
    try {
        role_from_name("tail");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("'tail'"));
        EXPECT_THAT(error.mend(), testing::HasSubstr("left_lower_leg"));
    }
}

TEST(Role, MissingRolesAreNamed) {
    RoleMap map;
    EXPECT_EQ(map.missing().size(), static_cast<size_t>(role_count));
    for (int i = 0; i < role_count; ++i) map.joint[i] = i;
    map[Role::neck] = -1;
    EXPECT_EQ(map.missing(), std::vector<Role>{Role::neck});
}

}  // namespace
}  // namespace toile::skin

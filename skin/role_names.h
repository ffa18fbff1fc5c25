#pragma once

#include <string>
#include <vector>

#include "skin/role.h"

namespace toile::skin {

/// A skeleton by names alone: parents come before children, -1 for a root.
struct NamedJoint {
    std::string name;
    int parent = -1;
};

/// Finds which joint does what, from names and from how joints hang together. Knows the names of the CMU motions and
/// their BVH, MakeHuman, Mixamo, Unreal, SMPL, VRM, Rigify, Biped, Daz and what resembles them: prefixes, separators
/// and case do not matter, side markers may stand anywhere. Where a limb's segment is cut into several bones the one
/// nearest the trunk is taken; twist and helper bones never are. The chest is the last joint that carries both arms,
/// the pelvis one that carries both legs.
///
/// Roles already set in `fixed` stay, and guide the rest. What is not found is -1.
RoleMap detect_roles(const std::vector<NamedJoint>& joint, const RoleMap& fixed = {});

}  // namespace toile::skin

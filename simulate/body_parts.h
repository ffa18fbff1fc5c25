#pragma once

#include <vector>

#include "skin/body.h"

namespace toile::simulate {

/// A body's triangles in parts whose gaps matter to a garment: what is no arm, then each arm with a border of a few
/// centimetres of the trunk around its shoulder, so that where a part is cut off lies inside another one. A level set
/// of the whole closes gaps that are narrower than two voxels; the union of the parts' level sets does not.
std::vector<std::vector<int>> body_parts(const skin::Body& body);

}  // namespace toile::simulate

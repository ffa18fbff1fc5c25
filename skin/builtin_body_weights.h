#pragma once

#include "skin/body.h"
#include "skin/builtin_body_shape.h"
#include "skin/surface_extraction.h"

namespace toile::skin {

/// Skin weights of the built-in body at the height of 1.75 m, over joints in the order of `Role`. Each vertex is first
/// shared out by where it lies along the limbs, with soft borders at the joints; the shares then diffuse over the
/// surface for one implicit step of heat flow, which rounds the borders where limbs meet. At most four a vertex, sum
/// one.
SkinWeights builtin_weights(const Surface& surface, const BuiltinJoints& joint, double girth);

}  // namespace toile::skin

#pragma once

#include <span>
#include <vector>

#include "evaluate/random.h"

namespace toile::evaluate {

std::vector<double> random_direction(std::size_t size, Random& random);

/// Where to try J after Jᵀ g is known: for each sample of `gradient` (all of one size) half along it and half at
/// random, so that the inner products below are not small by chance.
std::vector<double> probe_direction(std::span<const double> gradient, int samples, Random& random);

/// |<g, J v> - <Jᵀ g, v>| relative to the larger of |Jᵀ g| |v| and |g| |J v|, of one sample; zero where both products
/// vanish. NaN if one is NaN.
double identity_error(std::span<const double> loss_gradient, std::span<const double> tangent,
                      std::span<const double> gradient, std::span<const double> direction);

}  // namespace toile::evaluate

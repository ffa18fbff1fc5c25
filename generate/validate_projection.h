#pragma once

#include <string>

#include "generate/validate.h"

namespace toile::generate {

/// Checks a problem file: datasets and shapes, a mesh that `prior::rest_state` accepts, finite samples. A sample that
/// is not finite is a defect here, though the priors only leave it out.
Validation validate_problem(const std::string& path, const ValidateOptions& options = {});

/// Checks a projection file from the file alone:
///
/// - the contract's datasets, their types, shapes and attributes (if these fail, nothing further is read);
/// - the model against the mesh: edges, limits or rest lengths, stiffnesses;
/// - every sample: a status that fits its numbers, the residual computed again, as it is stored and within the
/// tolerance
///   where the status is 0, edges within their limits, multipliers of 0 or more, a gradient where there is a loss.
///
/// Throws Error if the file cannot be read at all.
Validation validate_projection(const std::string& path, const ValidateOptions& options = {});

}  // namespace toile::generate

#pragma once

#include <string>

#include "generate/validate.h"

namespace toile::generate {

/// Checks a noise file from the file alone:
///
/// - its datasets, their types, shapes and attributes (if these fail, nothing further is read);
/// - every sample: statuses that have a reason, finite cloth and distances where the status is accepted, distances that
///   are those of the variants' cloth to the accuracy it is stored with, a spread that
///   is the largest distance over the accepted variants, its root mean square and largest value, ids that ascend.
///
/// Throws Error if the file cannot be read at all, or is of another version.
Validation validate_noise(const std::string& path, const ValidateOptions& options = {});

}  // namespace toile::generate

#pragma once

#include <string>

#include "files/hdf5_file.h"
#include "generate/validate.h"

namespace toile::generate {

/// Whether a file looks like predictions (contract: /samples/id and /samples/predicted) and not like a problem, which
/// has a mesh.
bool is_predictions(const files::Hdf5File& file);

/// Checks a predictions file, which any program may write: types and shapes, unique ids, finite positions; with
/// `options.dataset` also that each id is one of that data set's samples, of its number of vertices. Floating point of
/// any width and integers of any width are taken. A few samples are in memory at a time.
Validation validate_predictions(const std::string& path, const ValidateOptions& options = {});

}  // namespace toile::generate

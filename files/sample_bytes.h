#pragma once

#include <string>
#include <string_view>

#include "files/dataset_file.h"

namespace toile::files {

/// A sample as bytes, to be sent between processes and kept in a journal: single precision where the data set has it,
/// so that a record that was read back is stored as the one that was made. The layout is this program version's own.
std::string sample_bytes(const SampleRecord& sample);

/// Throws Error for bytes that are no sample.
SampleRecord sample_from_bytes(std::string_view bytes);

}  // namespace toile::files

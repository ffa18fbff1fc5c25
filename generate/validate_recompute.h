#pragma once

#include <string>

#include "generate/validate.h"

namespace toile::generate {

/// "1%", "0.5 %" or "20": a share of the samples, or so many. Throws Error for anything else.
RecomputeChoice recompute_choice(const std::string& text);

/// Makes some samples of a data set again, in worker processes, and compares their digests with those stored: adds a
/// defect for each that differs, and a remark where the data set is another program version's. Which ones is a seeded
/// choice that depends on the data set alone. Replays of samples that fail are not kept.
///
/// The configuration is DIR/config.toml beside the data set, or in the folder above that of a shard's part, whose paths
/// are absolute; else the text in the file, with its paths relative to the working folder. Throws Error where none of
/// them is what the data set was made from: a file is gone, or it or the configuration has changed. The caller must
/// have one thread (`run_in_workers`).
void recompute_samples(const std::string& dataset, const ValidateOptions& options, Validation& result);

}  // namespace toile::generate

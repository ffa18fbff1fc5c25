#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/sample_tally.h"

namespace toile::generate {

struct MergeOptions {
    bool copy = false;   ///< one file that needs the shards no more; else it refers to them
    bool trust = false;  ///< digests are not computed again: for parts that the caller has just written or checked
    ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between samples
};

struct MergeSummary {
    std::string dataset;  ///< path of the file; empty where there was nothing to join
    int shards = 0, parts = 0;
    int samples = 0, accepted = 0;      ///< joined
    std::vector<FailedSample> failed;   ///< joined, but not accepted; `replay` is empty where there is no such file
    std::vector<std::int64_t> missing;  ///< pose numbers that no sealed part holds, in the order of the corpus
    std::vector<std::string> damaged;   ///< one line each: sample or part, and what is wrong with it

    bool is_complete() const { return failed.empty() && missing.empty() && damaged.empty(); }
};

/// Joins the sealed parts of all shards in `folder` into `folder`/dataset.h5 and its timing file, whole or not at all,
/// in the order of the corpus. Every sample is read and its digest computed again; what is missing or damaged is left
/// out and listed. The bytes depend on the parts alone: a copy is the file that a single run makes.
///
/// A file that refers to the parts (virtual datasets with relative names) is quickly made and small; the folder is then
/// moved as a whole. Other programs than ours read NaN where a part has gone, and keep one file open for each part.
///
/// Throws Error where the folder has no plan or no shards, and for parts that cannot belong to its corpus: of another
/// configuration, program version, number of samples or division into shards; two that hold the same samples.
MergeSummary merge(const std::string& folder, const MergeOptions& options);

/// "3, 7 to 12, 40": runs of numbers that follow each other.
std::string ranges_text(const std::vector<std::int64_t>& number);

}  // namespace toile::generate

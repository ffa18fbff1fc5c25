#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "files/dataset_file.h"

namespace toile::files {

/// What all shards of a corpus share, worked out once: DIR/plan.h5, a data set file without samples and, beyond it,
/// `/plan/pose_number` (N) int64, `/plan/split` (N) int8 and the attribute `remarks` of /plan.
struct CorpusPlan {
    DatasetHeader header;                   ///< mesh.rest_position is the neutral drape that all others start from
    std::vector<std::int64_t> pose_number;  ///< `[N]` of each slot
    std::vector<int> split;                 ///< `[N]`
    std::vector<std::string> remarks;       ///< on body, garment, neutral drape and image size, one sentence each

    int sample_count() const { return static_cast<int>(pose_number.size()); }
};

/// Whole or not at all. One process at a time.
void write_plan(const std::string& path, const CorpusPlan& plan);

/// Throws Error for a file that is no plan or is damaged.
CorpusPlan read_plan(const std::string& path);

}  // namespace toile::files

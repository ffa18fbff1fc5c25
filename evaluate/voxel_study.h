#pragma once

#include <string>

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

struct VoxelSweep {
    std::vector<double> voxel = {0.020, 0.014, 0.010, 0.007, 0.005, 0.0035, 0.0025};  ///< [m], 0.001 to 0.02
};

/// Error of the body's level set (signed distance, and depth of points inside) by voxel size, against the time to build
/// it: at points 2 mm inside to 5 mm outside of the body below each cloth vertex, compared with the exact distance to
/// the body's triangles. `dataset` names the file, for its configuration. A data set without a body has no such study
/// and says so.
Study study_voxels(const RuntimeSamples& samples, const std::string& dataset, const VoxelSweep& sweep,
                   const RepeatOptions& repeat, const Clock& clock);

}  // namespace toile::evaluate

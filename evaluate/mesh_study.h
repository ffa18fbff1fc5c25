#pragma once

#include <string>

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

struct MeshSweep {
    std::vector<double> edge_length = {0.05, 0.035, 0.025, 0.0175, 0.0125};  ///< garment.edge_length [m]
    int poses = 3;                                                           ///< of the samples, from the first on
};

/// Seconds of each prior's projection and backward pass, of a drape with the configured solver, and of one
/// factorisation, by the number of vertices: the data set's own garment, made anew at other edge lengths and draped in
/// the poses of its samples. Cost exponents are fitted. A garment that has no edge length to change (one from a file,
/// or of a configuration that cannot be built again) is left out and said why.
Study study_meshes(const RuntimeSamples& samples, const std::string& dataset, const MeshSweep& sweep,
                   const RepeatOptions& repeat, const Clock& clock);

/// Why the garment of a data set cannot be made anew at another edge length; empty where it can.
std::string why_no_sizes(const RuntimeSamples& samples, const std::string& dataset);

}  // namespace toile::evaluate

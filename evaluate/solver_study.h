#pragma once

#include <string>

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

struct SolverSweep {
    bool quick = false;                ///< fewer settings
    int poses = 3;                     ///< of the samples, from the first on
    double patience = 60;              ///< a series of settings ends after one whose drape took longer [s]
    std::vector<std::string> changes;  ///< overrides of the data set's configuration, such as a coarser garment
};

/// Error of the three simulators against seconds a drape, on a few poses of the data set's own scene: the distance to
/// where `implicit` comes to rest with far smaller steps and tolerances, if the gate accepts that (else the pose is
/// refused). Without the ladder: each setting has one try. `dataset` names the file, for its configuration; where the
/// scene cannot be built from it, the study is left out and says why.
Study study_solvers(const RuntimeSamples& samples, const std::string& dataset, const SolverSweep& sweep,
                    const RepeatOptions& repeat, const Clock& clock);

}  // namespace toile::evaluate

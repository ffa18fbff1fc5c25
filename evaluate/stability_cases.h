#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluate/stability_scenes.h"

namespace toile::evaluate {

/// One extreme that a solver has to survive.
struct StabilityCase {
    std::string group;                      ///< what is varied: "membrane stiffness"
    std::string name;                       ///< unique: "membrane stiffness x 1e-3, hanging"
    bool quick = false;                     ///< takes part in a short run: small, and no body to be made
    std::function<StabilityScene()> build;  ///< the scene, with the default solver
};

/// The whole suite, in the order it is shown.
std::vector<StabilityCase> stability_cases();

}  // namespace toile::evaluate

#pragma once

#include <string>
#include <vector>

#include "generate/generate.h"
#include "generate/validate.h"

namespace toile::generate {

struct RunSummary {
    GenerateSummary generated;
    std::vector<std::string> look;  ///< files to look at: glTF of body and cloth, a PNG sheet of the images
    Validation validation;
};

/// Everything there is so far: generates the data set, writes what one can look at, and validates the file.
RunSummary run(const SceneConfig& config, const GenerateOptions& options);

}  // namespace toile::generate

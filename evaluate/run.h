#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evaluate/accuracy.h"
#include "evaluate/predict.h"
#include "evaluate/report.h"
#include "generate/generate.h"
#include "generate/validate.h"

namespace toile::evaluate {

struct RunOptions {
    generate::GenerateOptions generate;  ///< its folder, jobs, progress and command are those of all of it
    std::string_view page_template;      ///< of the report, see filled_page.h
};

/// What a whole run came to.
struct RunSummary {
    generate::GenerateSummary generated;
    std::vector<std::string> look;  ///< files to look at: glTF of body and cloth, a PNG sheet of the images
    generate::Validation validation;
    std::vector<std::string> predictions;  ///< files
    std::optional<AccuracySummary> accuracy;
    std::optional<ReportSummary> report;
    std::vector<std::string> remark;  ///< what the configuration asks for and was not done, and why
    bool flawless = true;             ///< every sample, projection and case is as it should be
};

/// Everything that a scene asks for: generates the data set, writes what one can look at, validates the file, fits the
/// predictors of [predict], measures what [evaluate] says, and gathers it all in a report, beside the data set. Where
/// the data have no accepted sample to fit on, predictions are left out with a remark. Throws what its parts throw.
RunSummary run(const generate::SceneConfig& config, const RunOptions& options);

}  // namespace toile::evaluate

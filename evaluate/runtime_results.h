#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "evaluate/machine_facts.h"
#include "evaluate/runtime.h"

namespace toile::evaluate {

/// Studies as the member "study" of runtime.json, and back; a number that is not finite is null. `where` names the file
/// in an Error.
nlohmann::ordered_json studies_as_json(const std::vector<Study>& study);
std::vector<Study> studies_from_json(const nlohmann::ordered_json& json, const std::string& where);

/// Writes `summary.file`.
void write_runtime_results(const RuntimeSummary& summary, const RuntimeOptions& options, const RuntimeSamples& samples,
                           const std::vector<MachineFact>& machine);

}  // namespace toile::evaluate

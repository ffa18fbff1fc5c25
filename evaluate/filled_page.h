#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "evaluate/report_scene.h"

namespace toile::evaluate {

/// The template with its two markers, each of which it holds once, replaced: <!--TOILE_DATA--> by the document as JSON
/// in a script element of id "data", <!--TOILE_BLOBS--> by the blobs. No text in the document can end its element.
/// Throws std::logic_error for a template without its markers.
std::string filled_page(std::string_view page_template, const nlohmann::ordered_json& document,
                        const std::vector<ReportBlob>& blobs);

}  // namespace toile::evaluate

#pragma once

#include <string_view>

namespace toile::evaluate {

/// The template of report.html: a page without references to other files, made from evaluate/web and linked into the
/// program. It holds the markers `<!--TOILE_DATA-->` and `<!--TOILE_BLOBS-->` once each, for the report's data and for
/// the meshes of the samples that can be looked at.
std::string_view report_page();

}  // namespace toile::evaluate

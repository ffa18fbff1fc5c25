#pragma once

#include <string>

namespace toile::files {

/// Refuses TOML that toml++ 3.3 is not safe to be given: characters that are not ASCII outside of quotes and comments,
/// where TOML has none (a quote inside a bare word opens nothing), and after a backslash in a text of several lines (it
/// asks whether they are white space, and lets the optimiser assume that most letters with accents do not exist); and
/// tables nested without end (each level takes stack, and costs a dot). Throws Error with `source:line`. Internal to
/// files/.
void check_toml_text(const std::string& text, const std::string& source);

}  // namespace toile::files

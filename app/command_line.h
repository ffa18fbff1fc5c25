#pragma once

#include <string>

namespace toile::app {

/// Keeps the program's arguments, for data cards to show.
void keep_command_line(int argc, const char* const* argv);
/// The command as it may be typed again: "toile generate a.toml --out b"; words with other than plain characters are in
/// single quotes. Empty before `keep_command_line`.
const std::string& command_line();

}  // namespace toile::app

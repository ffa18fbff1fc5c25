#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace toile::files {

/// XXH3-128 as 32 hexadecimal digits: tells changed content from unchanged, not a protection against forgery.
std::string text_digest(std::string_view text);
/// Of a file's bytes; nothing where it cannot be read.
std::optional<std::string> file_digest(const std::string& path);

}  // namespace toile::files

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace toile::files {

/// Binary data as text, for pages that fetch nothing: base64, without line breaks.
std::string base64(const std::vector<std::uint8_t>& bytes);

/// The bytes as a zlib stream (RFC 1950), packed as small as zlib can.
std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes);

}  // namespace toile::files

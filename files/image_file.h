#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace toile::files {

/// An 8-bit picture with `channels` (1 grey, 3 RGB, 4 RGBA) interleaved, rows from the top.
struct Picture {
    int width = 0, height = 0, channels = 3;
    std::vector<uint8_t> value;  ///< `[height x width x channels]`
};

/// Writes a PNG: under another name first, then renamed. Throws Error where the disk refuses or the sizes do not fit.
void write_png(const std::string& path, const Picture& picture);

/// The bytes of such a PNG. Throws Error where the sizes do not fit.
std::vector<uint8_t> png_bytes(const Picture& picture);

/// Reads an 8-bit PNG of those channels; Error if it is missing or damaged.
Picture read_png(const std::string& path);

}  // namespace toile::files

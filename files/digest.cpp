#include "files/digest.h"

#include <xxhash.h>

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

namespace toile::files {
namespace {

std::string hexadecimal(XXH128_hash_t hash) {
    char text[33];
    std::snprintf(text, sizeof text, "%016" PRIx64 "%016" PRIx64, static_cast<std::uint64_t>(hash.high64),
                  static_cast<std::uint64_t>(hash.low64));
    return text;
}

}  // namespace

std::string text_digest(std::string_view text) {
    return hexadecimal(XXH3_128bits(text.data(), text.size()));
}

std::optional<std::string> file_digest(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return std::nullopt;
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::vector<char> block(1 << 18);
    while (stream) {
        stream.read(block.data(), static_cast<std::streamsize>(block.size()));
        XXH3_128bits_update(state.get(), block.data(), static_cast<size_t>(stream.gcount()));
    }
    if (stream.bad()) return std::nullopt;
    return hexadecimal(XXH3_128bits_digest(state.get()));
}

}  // namespace toile::files

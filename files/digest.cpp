#include "files/digest.h"

#include <xxhash.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <new>
#include <vector>

namespace toile::files {
namespace {

std::string hexadecimal(XXH128_hash_t hash) {
    char text[33];
    std::snprintf(text, sizeof text, "%016" PRIx64 "%016" PRIx64, static_cast<std::uint64_t>(hash.high64),
                  static_cast<std::uint64_t>(hash.low64));
    return text;
}

XXH3_state_t* fresh_state() {
    XXH3_state_t* state = XXH3_createState();
    if (!state) throw std::bad_alloc();
    XXH3_128bits_reset(state);
    return state;
}

}  // namespace

struct RunningDigest::State {
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state{fresh_state(), XXH3_freeState};
};

RunningDigest::RunningDigest() : state_(std::make_unique<State>()) {}
RunningDigest::~RunningDigest() = default;

void RunningDigest::add(const void* bytes, size_t size) {
    XXH3_128bits_update(state_->state.get(), bytes, size);
}

std::array<std::uint8_t, 16> RunningDigest::value() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_->state.get()));
    std::array<std::uint8_t, 16> value;
    std::copy(std::begin(canonical.digest), std::end(canonical.digest), value.begin());
    return value;
}

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

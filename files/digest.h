#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace toile::files {

/// XXH3-128 as 32 hexadecimal digits: tells changed content from unchanged, not a protection against forgery.
std::string text_digest(std::string_view text);
/// Of a file's bytes; nothing where it cannot be read.
std::optional<std::string> file_digest(const std::string& path);

/// The same of bytes that come one piece after the other.
class RunningDigest {
  public:
    RunningDigest();
    ~RunningDigest();
    RunningDigest(const RunningDigest&) = delete;
    RunningDigest& operator=(const RunningDigest&) = delete;

    void add(const void* bytes, size_t size);
    std::array<std::uint8_t, 16> value() const;  ///< big-endian

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace toile::files

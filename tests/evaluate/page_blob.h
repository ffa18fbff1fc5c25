#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluate/report_scene.h"

namespace toile::evaluate {

/// Bytes of base64, as a browser's atob gives them.
inline std::vector<std::uint8_t> base64_bytes(const std::string& text) {
    static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char letter : text) {
        if (letter == '=') break;
        const size_t value = letters.find(letter);
        if (value == std::string::npos) throw std::runtime_error("no base64");
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::uint8_t>(bits >> count));
    }
    return bytes;
}

/// The numbers in a blob, as the page reads them.
template <typename T>
std::vector<T> blob_values(const ReportBlob& blob) {
    const std::vector<std::uint8_t> packed = base64_bytes(blob.text);
    std::vector<std::uint8_t> bytes(1'000'000);
    uLongf size = bytes.size();
    if (uncompress(bytes.data(), &size, packed.data(), packed.size()) != Z_OK)
        throw std::runtime_error("no zlib stream");
    std::vector<T> value(size / sizeof(T));
    std::memcpy(value.data(), bytes.data(), size);
    return value;
}

}  // namespace toile::evaluate

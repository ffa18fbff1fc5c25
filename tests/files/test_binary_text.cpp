#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "files/binary_text.h"

namespace toile::files {
namespace {

std::vector<std::uint8_t> bytes(const std::string& text) {
    return {text.begin(), text.end()};
}

TEST(BinaryText, base64_is_that_of_rfc_4648) {
    EXPECT_EQ(base64({}), "");
    EXPECT_EQ(base64(bytes("f")), "Zg==");
    EXPECT_EQ(base64(bytes("fo")), "Zm8=");
    EXPECT_EQ(base64(bytes("foo")), "Zm9v");
    EXPECT_EQ(base64(bytes("foob")), "Zm9vYg==");
    EXPECT_EQ(base64(bytes("fooba")), "Zm9vYmE=");
    EXPECT_EQ(base64(bytes("foobar")), "Zm9vYmFy");
    EXPECT_EQ(base64({0xfb, 0xff, 0x00}), "+/8A");
}

TEST(BinaryText, what_is_deflated_inflates_to_itself) {
    for (const size_t size : {0u, 1u, 100'000u}) {
        std::vector<std::uint8_t> data(size);
        for (size_t k = 0; k < size; ++k) data[k] = static_cast<std::uint8_t>(k % 251);
        const std::vector<std::uint8_t> packed = deflated(data);
        std::vector<std::uint8_t> back(size + 1);
        uLongf length = back.size();
        ASSERT_EQ(uncompress(back.data(), &length, packed.data(), packed.size()), Z_OK);
        back.resize(length);
        EXPECT_EQ(back, data);
        EXPECT_LT(packed.size(), size / 10 + 20);
    }
}

}  // namespace
}  // namespace toile::files

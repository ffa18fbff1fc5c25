#include "files/binary_text.h"

#include <zlib.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <new>
#include <stdexcept>

namespace toile::files {

std::string base64(const std::vector<std::uint8_t>& bytes) {
    namespace iterators = boost::archive::iterators;
    using Letters = iterators::base64_from_binary<iterators::transform_width<const std::uint8_t*, 6, 8>>;
    // whole groups of three at first: the iterators read beyond an end that is not one
    const size_t whole = bytes.size() / 3 * 3;
    std::string text(Letters(bytes.data()), Letters(bytes.data() + whole));
    if (const size_t rest = bytes.size() - whole; rest > 0) {
        std::uint8_t group[3] = {};
        std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(whole), bytes.end(), group);
        const std::string letters(Letters(group), Letters(group + 3));
        text += letters.substr(0, rest + 1) + std::string(3 - rest, '=');
    }
    return text;
}

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::vector<std::uint8_t> packed(size);
    const int status =
        compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status != Z_OK) throw std::logic_error("zlib refuses to deflate");
    packed.resize(size);
    return packed;
}

}  // namespace toile::files

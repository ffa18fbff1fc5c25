#include "cloth/lane_array.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <algorithm>

namespace toile {
namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;

}  // namespace

LaneArray::LaneArray(std::size_t size) : size_(size) {
    const std::size_t bytes = size * sizeof(double);
    const bool huge = bytes >= 2 * huge_page;
    const std::align_val_t alignment{huge ? huge_page : 64};
    data_ = {static_cast<double*>(::operator new(bytes, alignment)), Free{alignment}};
#if defined(__linux__)
    // A panel's rows lie in more pages of the usual size than the processor keeps the addresses of. Refusal is no harm.
    if (huge) madvise(data_.get(), bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
    std::fill(data_.get(), data_.get() + size, 0.0);
}

}  // namespace toile

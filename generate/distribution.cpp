#include "generate/distribution.h"

#include <algorithm>
#include <cmath>

namespace toile::generate {

Distribution distribution(std::vector<double> value) {
    std::erase_if(value, [](double one) { return !std::isfinite(one); });
    if (value.empty()) return {};
    std::sort(value.begin(), value.end());
    const auto at = [&](int percent) {
        const size_t rank = (static_cast<size_t>(percent) * value.size() + 99) / 100;
        return value[std::max<size_t>(rank, 1) - 1];
    };
    return {value.front(), at(1), at(5), at(50), at(95), at(99), value.back()};
}

}  // namespace toile::generate

#pragma once

#include <algorithm>
#include <functional>

#include "cloth/parallel.h"

namespace toile::evaluate {

/// Calls `task(index)` for every index in [0, count), handed to threads some hundred at a time, as each takes
/// microseconds.
inline void for_blocks(int count, int jobs, const std::function<void(int index)>& task) {
    constexpr int block = 256;
    parallel_for((count + block - 1) / block, jobs, [&](int, int number) {
        const int end = std::min(count, (number + 1) * block);
        for (int index = number * block; index < end; ++index) task(index);
    });
}

}  // namespace toile::evaluate

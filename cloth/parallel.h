#pragma once

#include <functional>

namespace toile {

/// Calls `task(slot, index)` for every index in [0, count) from at most `threads` threads; `slot` in [0, threads) tells
/// which one, so a task can own a workspace. Which thread gets which index is not fixed: write results into slots by
/// index and sum them in index order afterwards. The first exception (lowest index) is thrown again once all threads
/// have stopped.
void parallel_for(int count, int threads, const std::function<void(int slot, int index)>& task);

}  // namespace toile

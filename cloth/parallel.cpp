#include "cloth/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace toile {

void parallel_for(int count, int threads, const std::function<void(int slot, int index)>& task) {
    threads = std::clamp(threads, 1, std::max(count, 1));
    std::vector<std::exception_ptr> failure(static_cast<size_t>(std::max(count, 0)));
    std::atomic<int> next{0};
    std::atomic<bool> stop{false};
    auto work = [&](int slot) {
        // An index that was taken is always run: so all below a failing one are, and the lowest failure is found.
        while (!stop) {
            const int index = next++;
            if (index >= count) return;
            try {
                task(slot, index);
            } catch (...) {
                failure[index] = std::current_exception();
                stop = true;
            }
        }
    };
    std::vector<std::thread> others;
    for (int slot = 1; slot < threads; ++slot) others.emplace_back(work, slot);
    work(0);
    for (std::thread& thread : others) thread.join();
    for (const std::exception_ptr& first : failure)
        if (first) std::rethrow_exception(first);
}

}  // namespace toile

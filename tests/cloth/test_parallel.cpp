#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include "cloth/parallel.h"

namespace toile {
namespace {

TEST(ParallelFor, every_index_once) {
    for (int threads : {1, 2, 5, 100}) {
        std::vector<std::atomic<int>> calls(37);
        parallel_for(37, threads, [&](int, int index) { ++calls[index]; });
        for (const auto& count : calls) EXPECT_EQ(count, 1) << threads;
    }
}

TEST(ParallelFor, slots_are_owned_by_one_thread) {
    std::vector<std::atomic<int>> busy(3);
    std::atomic<bool> shared{false}, outside{false};
    parallel_for(200, 3, [&](int slot, int) {
        if (slot < 0 || slot >= 3) {
            outside = true;
            return;
        }
        if (busy[slot]++ != 0) shared = true;
        --busy[slot];
    });
    EXPECT_FALSE(shared);
    EXPECT_FALSE(outside);
}

TEST(ParallelFor, nothing_to_do) {
    parallel_for(0, 4, [](int, int) { FAIL(); });
}

TEST(ParallelFor, exception_of_the_lowest_index_comes_out) {
    for (int threads : {1, 3}) {
        std::string message;
        try {
            parallel_for(50, threads, [](int, int index) { throw std::runtime_error(std::to_string(index)); });
        } catch (const std::runtime_error& error) {
            message = error.what();
        }
        EXPECT_EQ(message, "0");
    }
}

TEST(ParallelFor, stops_after_a_failure) {
    std::atomic<int> calls{0};
    EXPECT_THROW(parallel_for(1000000, 2,
                              [&](int, int) {
                                  ++calls;
                                  throw std::runtime_error("no");
                              }),
                 std::runtime_error);
    EXPECT_LE(calls, 2);
}

}  // namespace
}  // namespace toile

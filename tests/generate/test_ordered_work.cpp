#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "cloth/error.h"
#include "generate/ordered_work.h"

namespace toile::generate {
namespace {

files::SampleRecord record_of(int index) {
    files::SampleRecord record;
    record.id = index;
    return record;
}

TEST(OrderedWork, HandsOverInOrderWhateverTheThreadsDo) {
    for (const int jobs : {1, 2, 5}) {
        std::vector<int> taken;
        make_in_order(
            40, jobs,
            [](int index) {
                std::this_thread::sleep_for(std::chrono::microseconds(index % 3 * 300));
                return record_of(index);
            },
            [&](int index, files::SampleRecord record) {
                EXPECT_EQ(record.id, index);
                taken.push_back(index);
            },
            nullptr);
        ASSERT_EQ(taken.size(), 40u);
        for (int i = 0; i < 40; ++i) EXPECT_EQ(taken[i], i);
    }
}

TEST(OrderedWork, AFastThreadWaitsForASlowRecord) {
    std::atomic<int> furthest{0};
    make_in_order(
        100, 2,
        [&](int index) {
            if (index == 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                EXPECT_LE(furthest, 7) << "at most four records a job are in memory";
                EXPECT_GT(furthest, 0);
            }
            furthest = std::max<int>(furthest, index);
            return record_of(index);
        },
        [](int, files::SampleRecord) {}, nullptr);
    EXPECT_EQ(furthest, 99);
}

TEST(OrderedWork, AFailureEndsTheWorkAndIsThrown) {
    for (const int jobs : {1, 3}) {
        std::atomic<int> made{0};
        const auto work = [&] {
            make_in_order(
                1000, jobs,
                [&](int index) {
                    if (index == 5) throw Error("sample 5");
                    ++made;
                    return record_of(index);
                },
                [](int, files::SampleRecord) {}, nullptr);
        };
        EXPECT_THROW(work(), Error);
        EXPECT_LT(made, 1000);
        const auto full_disk = [&] {
            make_in_order(
                1000, jobs, record_of,
                [](int index, files::SampleRecord) {
                    if (index == 3) throw Error("full");
                },
                nullptr);
        };
        EXPECT_THROW(full_disk(), Error);
    }
}

TEST(OrderedWork, AnInterruptEndsTheWork) {
    std::atomic<bool> interrupted{false};
    int taken = 0;
    const auto work = [&] {
        make_in_order(
            1000, 2, record_of,
            [&](int index, files::SampleRecord) {
                ++taken;
                if (index == 4) interrupted = true;
            },
            &interrupted);
    };
    EXPECT_THROW(work(), Interrupted);
    EXPECT_GE(taken, 5);
    EXPECT_LT(taken, 1000);
}

}  // namespace
}  // namespace toile::generate

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "evaluate/study_timing.h"
#include "generate/ordered_work.h"

namespace toile::evaluate {
namespace {

/// Time passes only where a task says so.
struct FakeTime {
    double now = 100.0;
    Clock clock() {
        return [this] { return now; };
    }
};

TEST(Spread, TakesQuartilesAndRange) {
    const Spread some = quartiles({5, 1, 4, 2, 3});
    EXPECT_EQ(some.low, 2.0);
    EXPECT_EQ(some.middle, 3.0);
    EXPECT_EQ(some.high, 4.0);
    EXPECT_DOUBLE_EQ(quartiles({0, 1}).low, 0.25);
    EXPECT_EQ(range({5, 1, 4}).low, 1.0);
    EXPECT_EQ(range({5, 1, 4}).middle, 4.0);
    EXPECT_EQ(range({5, 1, 4}).high, 5.0);
    EXPECT_TRUE(std::isnan(range({}).middle));
}

TEST(TimeInterleaved, TakesTasksInTurns) {
    FakeTime time;
    std::string order;
    const std::vector<TimedTask> task{
        {"a", [&](int s) { order += "a" + std::to_string(s); }},
        {"b", [&](int s) { order += "b" + std::to_string(s); }, [&](int s) { order += "p" + std::to_string(s); }}};
    time_interleaved(
        task, 2, [&] { order += "u"; }, {.rounds = 2}, time.clock());
    EXPECT_EQ(order, "ua0p0b0ua1p1b1ua0p0b0ua1p1b1");
}

TEST(TimeInterleaved, MeasuresWhatTasksTakeAndNotWhatPreparesThem) {
    FakeTime time;
    const std::vector<TimedTask> task{{"a", [&](int s) { time.now += 1.0 + s; }, [&](int) { time.now += 50.0; }}};
    const Timings timings = time_interleaved(
        task, 3, [&] { time.now += 0.5; }, {.rounds = 4}, time.clock());
    EXPECT_EQ(timings.rounds(0), 4);
    EXPECT_DOUBLE_EQ(timings.seconds(0).low, 1.5);
    EXPECT_DOUBLE_EQ(timings.seconds(0).middle, 2.0);
    EXPECT_DOUBLE_EQ(timings.seconds(0).high, 2.5);
    EXPECT_DOUBLE_EQ(timings.seconds_by_round(0).middle, 2.0);
    EXPECT_DOUBLE_EQ(timings.unit().middle, 0.5);
    EXPECT_DOUBLE_EQ(timings.units(0).middle, 4.0);
}

TEST(TimeInterleaved, RatiosDoNotSeeAMachineThatSlowsDown) {
    FakeTime time;
    double slowness = 1.0;
    int units = 0;
    const std::vector<TimedTask> task{{"a", [&](int) { time.now += 3.0 * slowness; }}};
    const auto unit = [&] {
        if (++units == 3) slowness = 4.0;  // the third round, and those after it
        time.now += slowness;
    };
    const Timings timings = time_interleaved(task, 1, unit, {.rounds = 5}, time.clock());
    EXPECT_DOUBLE_EQ(timings.units(0).low, 3.0);
    EXPECT_DOUBLE_EQ(timings.units(0).high, 3.0);
    EXPECT_DOUBLE_EQ(timings.seconds_by_round(0).low, 3.0);
    EXPECT_DOUBLE_EQ(timings.seconds_by_round(0).high, 12.0);
}

TEST(TimeInterleaved, StopsRepeatingWhatTakesLong) {
    FakeTime time;
    const std::vector<TimedTask> task{{"quick", [&](int) { time.now += 1.0; }},
                                      {"slow", [&](int) { time.now += 40.0; }}};
    const Timings timings = time_interleaved(task, 1, {}, {.rounds = 5, .least = 2, .budget = 20.0}, time.clock());
    EXPECT_EQ(timings.rounds(0), 5);
    EXPECT_EQ(timings.rounds(1), 2);
    EXPECT_TRUE(std::isnan(timings.units(0).middle)) << "there was no unit";
}

TEST(TimeInterleaved, StopsWhenInterrupted) {
    FakeTime time;
    std::atomic<bool> interrupted = false;
    int runs = 0;
    RepeatOptions options;
    options.interrupted = &interrupted;
    const std::vector<TimedTask> task{{"a", [&](int) {
                                           ++runs;
                                           interrupted = true;
                                       }}};
    EXPECT_THROW(time_interleaved(task, 3, {}, options, time.clock()), generate::Interrupted);
    EXPECT_EQ(runs, 1);
}

}  // namespace
}  // namespace toile::evaluate

#include "evaluate/study_timing.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "generate/ordered_work.h"

namespace toile::evaluate {
namespace {

/// Linear between the values, which are sorted.
double quantile(const std::vector<double>& sorted, double share) {
    if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<size_t>(place);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    const double part = place - static_cast<double>(below);
    return (1.0 - part) * sorted[below] + part * sorted[above];
}

Spread spread_of(std::vector<double> value, double low, double high) {
    std::sort(value.begin(), value.end());
    return {quantile(value, low), quantile(value, 0.5), quantile(value, high)};
}

void stop_if_asked(const RepeatOptions& options) {
    if (options.interrupted && *options.interrupted) throw generate::Interrupted("interrupted: no study was written");
}

/// One round of the tasks that are still in it. Adds to `spent`.
void time_round(const std::vector<TimedTask>& task, const std::vector<bool>& in, int samples,
                const std::function<void()>& unit, const RepeatOptions& options, const Clock& clock, Timings& timings,
                std::vector<double>& spent) {
    std::vector<double> of_unit;
    std::vector<std::vector<double>> seconds(task.size());
    for (int s = 0; s < samples; ++s) {
        if (unit) {
            const double start = clock();
            unit();
            of_unit.push_back(clock() - start);
        }
        for (size_t t = 0; t < task.size(); ++t) {
            if (!in[t]) continue;
            stop_if_asked(options);
            if (task[t].prepare) task[t].prepare(s);
            const double start = clock();
            task[t].run(s);
            seconds[t].push_back(clock() - start);
        }
    }
    if (unit) timings.add_unit(range(of_unit).middle);
    for (size_t t = 0; t < task.size(); ++t) {
        if (!in[t]) continue;
        spent[t] += std::accumulate(seconds[t].begin(), seconds[t].end(), 0.0);
        timings.add_round(static_cast<int>(t), std::move(seconds[t]));
    }
}

}  // namespace

Clock wall_clock() {
    return [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

Clock processor_clock() {
    return [] {
        timespec time{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
}

Spread quartiles(std::vector<double> value) {
    return spread_of(std::move(value), 0.25, 0.75);
}

Spread range(std::vector<double> value) {
    return spread_of(std::move(value), 0.0, 1.0);
}

Spread Timings::seconds(int task) const {
    std::vector<double> of_sample;
    for (int s = 0; s < samples_ && rounds(task) > 0; ++s) {
        std::vector<double> repeated;
        for (const std::vector<double>& round : seconds_[task]) repeated.push_back(round[s]);
        of_sample.push_back(range(std::move(repeated)).middle);
    }
    return quartiles(std::move(of_sample));
}

Spread Timings::seconds_by_round(int task) const {
    std::vector<double> mean;
    for (const std::vector<double>& round : seconds_[task])
        mean.push_back(std::accumulate(round.begin(), round.end(), 0.0) / samples_);
    return range(std::move(mean));
}

Spread Timings::units(int task) const {
    std::vector<double> ratio;
    // A task that left early took part in the first rounds.
    for (int round = 0; round < rounds(task) && round < static_cast<int>(unit_.size()); ++round) {
        const std::vector<double>& seconds = seconds_[task][round];
        ratio.push_back(std::accumulate(seconds.begin(), seconds.end(), 0.0) / (samples_ * unit_[round]));
    }
    return range(std::move(ratio));
}

Timings time_interleaved(const std::vector<TimedTask>& task, int samples, const std::function<void()>& unit,
                         const RepeatOptions& options, const Clock& clock) {
    Timings timings(static_cast<int>(task.size()), samples);
    std::vector<bool> in(task.size(), true);
    std::vector<double> spent(task.size(), 0.0);
    for (int round = 0; round < options.rounds; ++round) {
        if (options.progress) options.progress({"timing", round, options.rounds, 0});
        time_round(task, in, samples, unit, options, clock, timings, spent);
        for (size_t t = 0; t < task.size(); ++t) in[t] = round + 1 < options.least || spent[t] < options.budget;
        if (std::none_of(in.begin(), in.end(), [](bool one) { return one; })) break;
    }
    return timings;
}

}  // namespace toile::evaluate

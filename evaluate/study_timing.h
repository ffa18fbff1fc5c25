#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "generate/progress.h"

namespace toile::evaluate {

/// Seconds from any fixed moment on. Given from outside, so that tests do not depend on time.
using Clock = std::function<double()>;
Clock wall_clock();
/// Processor time of this process, all threads: of work on one thread what a clock on the wall shows on a machine that
/// does nothing else.
Clock processor_clock();

/// A value with its spread. What low and high are is told where it is made.
struct Spread {
    double low = 0, middle = 0, high = 0;
};
/// Median with the quartiles (linear between the values). NaN of none.
Spread quartiles(std::vector<double> value);
/// Median with the smallest and the largest. NaN of none.
Spread range(std::vector<double> value);

/// Something to be timed on each of some samples.
struct TimedTask {
    std::string name;
    std::function<void(int sample)> run;
    std::function<void(int sample)> prepare = {};  ///< before each run, not timed
};

/// How often things are timed.
struct RepeatOptions {
    int rounds = 5;      ///< at most, at least 1
    int least = 2;       ///< rounds that every task gets
    double budget = 20;  ///< a task that has taken longer than this in all gets no round beyond `least` [s]
    generate::ProgressCallback progress = {};
    const std::atomic<bool>* interrupted = nullptr;  ///< throws generate::Interrupted between two tasks
};

/// What `time_interleaved` measured.
class Timings {
  public:
    Timings(int tasks, int samples) : samples_(samples), seconds_(tasks) {}

    void add_round(int task, std::vector<double> seconds) { seconds_[task].push_back(std::move(seconds)); }
    void add_unit(double seconds) { unit_.push_back(seconds); }

    int rounds(int task) const { return static_cast<int>(seconds_[task].size()); }
    /// Seconds a sample: of each sample the median over rounds, then median and quartiles over the samples.
    Spread seconds(int task) const;
    /// The samples' mean [s]: median, smallest and largest over the rounds.
    Spread seconds_by_round(int task) const;
    /// The samples' mean in units (see `time_interleaved`): of each round the ratio within it, then median, smallest
    /// and largest over the rounds. NaN where there is no unit.
    Spread units(int task) const;
    /// The unit itself [s]: median, smallest and largest over the rounds.
    Spread unit() const { return range(unit_); }

  private:
    int samples_;
    std::vector<std::vector<std::vector<double>>> seconds_;  // by task, round, sample
    std::vector<double> unit_;                               // by round
};

/// Times all tasks on all samples, round after round, each sample's tasks one after the other: what makes a machine
/// slower for a while hits all tasks alike. `unit`, where there is one, is timed with every sample, the median of a
/// round being that round's unit.
Timings time_interleaved(const std::vector<TimedTask>& task, int samples, const std::function<void()>& unit,
                         const RepeatOptions& options, const Clock& clock);

}  // namespace toile::evaluate

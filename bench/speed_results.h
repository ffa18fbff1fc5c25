#pragma once

#include <benchmark/benchmark.h>

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "files/metric_file.h"

namespace toile::bench {

/// One row of the speed table as measured.
struct Timing {
    double milliseconds = 0;  ///< processor time a sample, the least of all repetitions
    double iterations = 0;    ///< mean second-order steps of a sample
    std::string label;
    std::string refused;  ///< why it was not timed, or empty
};

/// What a run of all rows found. Names are those of `register_prior_benchmarks`.
struct SpeedResults {
    std::map<std::string, Timing> timing;
    std::map<std::string, double> peak_memory;  ///< [MB] by prior; -1: not measured
    double overstretched_share = 0;             ///< of the table's predictions

    /// Time of a row in units of the factorisation, NaN if either was not timed.
    double units(const std::string& row) const;
    /// Slope of log time over log vertices, fitted to `scaling/<name>/<vertices>`; NaN with fewer than two sizes.
    double exponent(const std::string& name) const;
};

/// Collects the repetitions of Google Benchmark's runs; shows on stderr how far they are.
class TimingCollector : public benchmark::BenchmarkReporter {
  public:
    explicit TimingCollector(std::map<std::string, Timing>& timing) : timing_(timing) {}
    bool ReportContext(const Context& context) override;
    void ReportRuns(const std::vector<Run>& runs) override;

  private:
    std::map<std::string, Timing>& timing_;
};

/// The speed table as Markdown, beside the targets; then scaling, memory, and what was refused.
void print_speed_table(std::ostream& out, const SpeedResults& results);

/// What a gate compares: ratios, iterations, exponents, memory. No absolute time.
std::vector<files::Metric> metrics(const SpeedResults& results);

}  // namespace toile::bench

#pragma once

#include <string>
#include <vector>

namespace toile::bench {

/// One figure of a benchmark run: what a baseline holds and a gate compares.
struct Metric {
    std::string key;   ///< unique, such as "inextensibility/1e-6/forward/batch"
    double value = 0;  ///< as measured
    std::string unit;  ///< "factorisations", "iterations", "MB", "exponent"
    bool lower_is_better = true;
    double tolerance = 0.2;  ///< relative: how much worse than the baseline is still no regression
};

/// Throw Error, naming the file, if it cannot be written, read, or is not a list of metrics.
void write_metrics(const std::vector<Metric>& metrics, const std::string& file);
std::vector<Metric> read_metrics(const std::string& file);

/// One line for each metric of `baseline` that `measured` lacks or has worse by more than the baseline's tolerance.
std::vector<std::string> regressions(const std::vector<Metric>& baseline, const std::vector<Metric>& measured);

}  // namespace toile::bench

#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files/metric_file.h"

namespace toile::bench {

/// Of what was not measured.
inline constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// A table's cell; empty for no number.
std::string number(double value, int digits = 3);

/// What a baseline holds of a bench: lower is better, unless said otherwise.
files::Metric metric(const std::string& name, double value, const std::string& unit, double tolerance,
                     files::MetricDirection direction = files::MetricDirection::lower);

/// Slope of log time over log size, fitted to pairs of size and time; no number with fewer than two.
double scaling_exponent(const std::vector<std::pair<double, double>>& size_and_time);

}  // namespace toile::bench

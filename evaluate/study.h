#pragma once

#include <string>
#include <variant>
#include <vector>

#include "evaluate/study_timing.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// A point of a curve: x and y with their spreads.
struct StudyPoint {
    std::string label;
    Spread x, y;
};

struct StudySeries {
    std::string name;
    std::vector<StudyPoint> point;
};

struct StudyAxis {
    std::string label, unit;
    bool log = true;
};

/// Curves in one picture.
struct StudyCurves {
    std::string id, title, note;
    StudyAxis x, y;
    std::vector<StudySeries> series;
};

struct StudyColumn {
    std::string name, unit;
};
/// A number that is not finite is shown as missing.
using StudyCell = std::variant<std::string, double, Spread>;
struct StudyTable {
    std::string id, title, note;
    std::vector<StudyColumn> column;
    std::vector<std::vector<StudyCell>> row;
};

/// What one study found.
struct Study {
    std::string name, title;
    std::vector<std::string> text;      ///< paragraphs: what was measured, how
    std::vector<std::string> left_out;  ///< what was not, and why; one sentence each
    int refused = 0;  ///< references that could not be certified and settings that ended without a result: named in
                      ///< `left_out`
    std::vector<StudyCurves> curves;
    std::vector<StudyTable> table;
    std::vector<files::Metric> metric;
};

/// Adds what every timed thing has: `<name>/time_ratio` in units of the same run, which is gated (unless it is too
/// short), and
/// `<name>/seconds`, which is not. Intervals: smallest and largest round, and quartiles of the samples.
void add_time_metrics(Study& study, const std::string& name, const Timings& timings, int task, int samples);
/// An error or another figure of the samples; `tolerance` 0: told, not gated.
void add_metric(Study& study, const std::string& name, const Spread& value, const std::string& unit, int samples,
                double tolerance = 0.0);

/// y = factor * x^exponent, least squares in logarithms over points with positive x and y.
struct PowerLaw {
    double exponent, factor;
    double exponent_low, exponent_high;  ///< exponent ∓ twice its standard error; NaN with fewer than three points
};
/// All members NaN with fewer than two different x.
PowerLaw fit_power_law(const std::vector<double>& x, const std::vector<double>& y);

/// "0.00123" -> "1.23e-03" and so on: three digits, short.
std::string short_number(double value);

}  // namespace toile::evaluate

#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "bench/drape_timing.h"
#include "files/metric_file.h"

namespace toile::bench {

/// What a run of `bench_simulate` found, by row:
///
/// - `drape/<size>`: the T-shirt over the poses of the arms, with `implicit`;
/// - `solver/<solver>/<setting>`: the same at some 400 vertices, without the ladder, with the error against the
/// tightest `implicit`;
/// - `without/<what>`: the scene of `drape/3000` without self-contact; a hanging patch of its size, with self-contact
///   and without: no body.
struct DrapeResults {
    std::map<std::string, DrapeTiming> timing;
    double peak_memory = -1;  ///< of one drape at 3,000 vertices [MB]; -1: not measured

    /// Slope of log median time over log vertices of `drape/*`; NaN with fewer than two sizes.
    double exponent() const;
    /// Median seconds a solver takes to an error [m], between its settings on a line of logarithms; NaN where its
    /// settings don't reach from above to below it.
    double seconds_at_error(const std::string& solver, double error) const;
};

/// The error at which solvers are compared [m].
inline constexpr double compared_error = 2e-3;

/// All of it as Markdown.
void print_drape_table(std::ostream& out, const DrapeResults& results);

/// What a gate compares: times in factorisations, iterations, shares, exponent, memory. No absolute time.
std::vector<files::Metric> metrics(const DrapeResults& results);

}  // namespace toile::bench

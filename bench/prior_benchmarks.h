#pragma once

#include <map>
#include <string>
#include <vector>

namespace toile::bench {

/// The speed table's mesh, and how its samples are solved together.
inline constexpr int table_around = 53, table_along = 56, table_batch = 64;

/// Sizes of the scaling row: tubes of about 3,000 to 50,000 vertices, eight samples each.
struct TubeSize {
    int around, along;
    int vertices() const { return around * along; }
};
const std::vector<TubeSize>& scaling_sizes();
inline constexpr int scaling_batch = 8;

/// Registers every row of the speed table with Google Benchmark, as `prior/method/tolerance/what/how`, beside
/// `unit/cholmod_default` and `scaling/prior/what/vertices`. Each has counters `samples` (of one
/// iteration) and `iterations` (mean second-order steps of a sample). What does not reach its tolerance is refused
/// before it is timed. `repetitions` of each row, more of the units.
void register_prior_benchmarks(int repetitions);

/// Peak resident size [MB] by prior, of forward and backward for a batch of 64 on the table's mesh, each in a process
/// of its own; -1 if a sample did not converge. To be called before anything else.
std::map<std::string, double> peak_memories();

}  // namespace toile::bench

#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "files/metric_file.h"

namespace toile::bench {

/// What a bench does with a baseline: compare with one, write one; either path may be empty.
struct BaselineFiles {
    std::string gate, written;
    std::string kind;  ///< the bench's name: a baseline of another is refused
};

/// Measures, once the baseline to compare with has been read; writes, compares, says what came of it. Returns the exit
/// status: 1 for a regression.
int measure_against(const BaselineFiles& baseline, const std::function<std::vector<files::Metric>()>& measure,
                    std::ostream& out);

/// Runs a program, with its errors on stderr: exit status 2 where its input is at fault, 1 for any other.
int run_program(const char* name, const std::function<int()>& run);

}  // namespace toile::bench

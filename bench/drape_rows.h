#pragma once

#include <string>

#include "bench/drape_results.h"

namespace toile::bench {

struct DrapeRowOptions {
    std::string filter;  ///< regular expression; empty: all rows
    int poses = 20;      ///< drapes a row
    bool large = false;  ///< also the largest size
};

/// Measures all rows that the filter names (see `DrapeResults`), and `memory`. Memory first, while this process is
/// small. Throws Error for a filter that is not a regular expression.
DrapeResults measure_rows(const DrapeRowOptions& options);

}  // namespace toile::bench

#pragma once

#include <vector>

namespace toile::generate {

/// Values that some share of all lies at or below: nearest rank, so each is one of the values.
struct Distribution {
    double smallest = 0, first = 0, fifth = 0;  ///< and the percentiles 1 and 5
    double median = 0, ninety_fifth = 0, ninety_ninth = 0, largest = 0;
};

/// Of the finite values; of none, all zero.
Distribution distribution(std::vector<double> value);

}  // namespace toile::generate

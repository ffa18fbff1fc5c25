#include <gtest/gtest.h>

#include <cmath>

#include "bench/figures.h"

namespace toile::bench {
namespace {

TEST(Figures, CellsAreShortAndEmptyWithoutANumber) {
    EXPECT_EQ(number(3.14159), "3.14");
    EXPECT_EQ(number(1234.5, 4), "1234");
    EXPECT_EQ(number(no_number), "");
}

TEST(Figures, FitsTheExponent) {
    EXPECT_NEAR(scaling_exponent({{1e3, 2.0}, {1e4, 2.0 * std::pow(10.0, 1.3)}}), 1.3, 1e-12);
    EXPECT_NEAR(scaling_exponent({{1e3, 1.0}, {1e4, 10.0}, {1e5, 100.0}}), 1.0, 1e-12);
    EXPECT_TRUE(std::isnan(scaling_exponent({{1e3, 2.0}})));
}

}  // namespace
}  // namespace toile::bench

#include <gtest/gtest.h>

#include "simulate/crossings.h"
#include "simulate/sheet_gap.h"
#include "tests/simulate/tangled_cloth.h"

namespace toile::simulate {
namespace {

struct SheetGapTest : testing::Test {
    test::Surface layers =
        test::joined(test::surface(test::cloth_square(4, 0.1, 0.0)), test::surface(test::cloth_square(4, 0.1, 1e-5)));
    Topology topology = build_topology(layers.triangle);
    std::vector<bool> all = std::vector<bool>(50, true), none = std::vector<bool>(50, false);
};

TEST_F(SheetGapTest, MeasuresOnlyWhatIsMarked) {
    SheetGap gap(layers.triangle, topology.edge, all);
    EXPECT_NEAR(gap.smallest(all, 1e-3, layers.position), 1e-5, 1e-15);
    EXPECT_EQ(gap.smallest(none, 1e-3, layers.position), 1e-3);
    EXPECT_EQ(gap.smallest(all, 5e-6, layers.position), 5e-6);
}

TEST_F(SheetGapTest, OpensEvenlyAndLeavesPinsAlone) {
    std::vector<bool> free = all;
    for (int v = 0; v < 25; ++v) free[v] = false;
    SheetGap gap(layers.triangle, topology.edge, free);
    Positions x = layers.position;
    for (int pass = 0; pass < 20; ++pass) gap.open(all, 1e-3, 1.0, x);
    EXPECT_NEAR(gap.smallest(all, 2e-3, x), 1e-3, 1e-6);
    EXPECT_EQ(x.topRows(25), layers.position.topRows(25));
    EXPECT_LT(x.bottomRows(25).col(1).maxCoeff(), 2e-3);
    EXPECT_TRUE(find_crossings(layers.triangle, topology, x).empty());
}

TEST_F(SheetGapTest, LeavesWhatIsNotMarkedAlone) {
    SheetGap gap(layers.triangle, topology.edge, all);
    Positions x = layers.position;
    gap.open(none, 1e-3, 1.0, x);
    EXPECT_EQ(x, layers.position);
}

}  // namespace
}  // namespace toile::simulate

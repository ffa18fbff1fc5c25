#include <gtest/gtest.h>

#include <set>

#include "evaluate/stress_problem.h"

namespace toile::evaluate {
namespace {

TEST(StressProblem, ItsNumberAloneDecides) {
    const StressDraw draw;
    const StressProblem first = draw_problem(draw, 41), again = draw_problem(draw, 41), next = draw_problem(draw, 42);
    EXPECT_EQ(first.predicted, again.predicted);
    EXPECT_EQ(first.description(0), again.description(0));
    EXPECT_NE(first.description(0), next.description(0));
    StressDraw other;
    other.seed = 2;
    EXPECT_NE(draw_problem(other, 41).description(0), first.description(0));
}

TEST(StressProblem, TheDrawCoversKindsUnitsAndBatches) {
    StressDraw draw;
    draw.largest = 60;
    draw.huge_every = 0;
    std::set<PredictionKind> kinds;
    std::set<MeshKind> meshes;
    std::set<double> units;
    std::set<int> batches;
    for (int number = 0; number < 300; ++number) {
        const StressProblem problem = draw_problem(draw, number);
        kinds.insert(problem.kind.begin(), problem.kind.end());
        meshes.insert(problem.mesh_kind);
        units.insert(problem.length_unit);
        batches.insert(problem.sample_count());
        EXPECT_LT(problem.mesh.vertex_count(), 150);
        EXPECT_GE(problem.stretch_limit, -0.1);
        EXPECT_LE(problem.stretch_limit, 0.5);
    }
    EXPECT_EQ(kinds.size(), static_cast<std::size_t>(prediction_kind_count));
    EXPECT_EQ(meshes.size(), 5u);
    EXPECT_EQ(units.size(), 3u);
    EXPECT_EQ(batches.size(), 9u);
}

TEST(StressProblem, HugeOnesCome) {
    StressDraw draw;
    draw.huge_every = 2;
    int huge = 0;
    for (int number = 0; number < 8; ++number) huge += draw_problem(draw, number).mesh.vertex_count() > 9000;
    EXPECT_EQ(huge, 4);
}

}  // namespace
}  // namespace toile::evaluate

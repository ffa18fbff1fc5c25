#include <gtest/gtest.h>

#include "cloth/factorisation_unit.h"
#include "tests/cloth/vertex_graphs.h"

namespace toile {
namespace {

TEST(FactorisationUnit, FactorsTheMeshHessian) {
    constexpr int columns = 12, rows = 12;
    const VertexGraph grid = grid_graph("grid", columns, rows, false);
    Edges edge(static_cast<Eigen::Index>(grid.pairs.size()), 2);
    for (Eigen::Index e = 0; e < edge.rows(); ++e) edge.row(e) << grid.pairs[e].first, grid.pairs[e].second;
    Positions position(grid.vertex_count, 3);
    for (int v = 0; v < grid.vertex_count; ++v) position.row(v) << 0.015 * (v % columns), 0.0, 0.015 * (v / columns);
    FactorisationUnit unit(edge, position);
    ASSERT_TRUE(unit.factor());
    EXPECT_LT(unit.solve_error(), 1e-12);
    EXPECT_NE(unit.description().find("nonzeros"), std::string::npos);
}

}  // namespace
}  // namespace toile

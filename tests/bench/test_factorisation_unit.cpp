#include <gtest/gtest.h>

#include "bench/factorisation_unit.h"
#include "cloth/topology.h"
#include "evaluate/problem_meshes.h"

namespace toile::bench {
namespace {

TEST(FactorisationUnit, FactorsTheMeshHessian) {
    evaluate::Random random(1);
    const ClothMesh mesh = evaluate::open_tube(12, 12, 0.015, 0.15, random);
    const Edges edge = build_topology(mesh.triangle).edge;
    FactorisationUnit unit(edge, mesh.rest_position);
    ASSERT_TRUE(unit.factor());
    EXPECT_LT(unit.solve_error(), 1e-12);
    EXPECT_NE(unit.description().find("nonzeros"), std::string::npos);
}

}  // namespace
}  // namespace toile::bench

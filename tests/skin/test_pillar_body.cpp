#include <gtest/gtest.h>

#include <cmath>

#include "skin/pillar_body.h"
#include "skin/skinning.h"

namespace toile::skin {
namespace {

TEST(PillarBody, StandsOnTheGroundAMetreHigh) {
    const Body body = pillar_body();
    EXPECT_NO_THROW(check_body(body, "pillar"));
    EXPECT_NEAR(body.rest_position.col(1).minCoeff(), 0.0, 1e-3);
    EXPECT_NEAR(body.rest_position.col(1).maxCoeff(), 1.0, 1e-3);
    EXPECT_NEAR(body.rest_position.leftCols(1).cwiseAbs().maxCoeff(), 0.1, 1e-3);
}

TEST(PillarBody, BendsItsUpperHalfAlone) {
    const Body body = pillar_body();
    const double angle = 0.3;
    const Positions bent = skin_positions(body, bent_pillar(angle), SkinningMethod::linear);
    int top = 0;
    body.rest_position.col(1).maxCoeff(&top);
    const Eigen::RowVector3d from = body.rest_position.row(top) - Eigen::RowVector3d(0.0, 0.5, 0.0);
    const Eigen::RowVector3d expected(std::cos(angle) * from.x() - std::sin(angle) * from.y(),
                                      0.5 + std::sin(angle) * from.x() + std::cos(angle) * from.y(), from.z());
    EXPECT_LT((bent.row(top) - expected).norm(), 1e-12);
    for (int v = 0; v < body.vertex_count(); ++v)
        if (body.rest_position(v, 1) < 0.4) EXPECT_EQ(bent.row(v), body.rest_position.row(v)) << v;
}

}  // namespace
}  // namespace toile::skin

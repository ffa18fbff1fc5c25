#include <gtest/gtest.h>

#include "prior/cone_interior_point.h"
#include "tests/prior/inextensible_cases.h"

namespace toile::prior::test {
namespace {

/// |K u − Σ B_eᵀ z_e¹| of the largest entry.
double imbalance(const ConeProgram& program, const ConeIterate& iterate) {
    Eigen::VectorXd force(iterate.u.size());
    for (Eigen::Index i = 0; i < force.size(); ++i) force[i] = program.stiffness[i / 3] * iterate.u[i];
    for (Eigen::Index e = 0; e < program.edge.rows(); ++e) {
        force.segment<3>(3 * program.edge(e, 0)) -= iterate.z.col(e).tail<3>();
        force.segment<3>(3 * program.edge(e, 1)) += iterate.z.col(e).tail<3>();
    }
    return force.lpNorm<Eigen::Infinity>();
}

void expect_inside(const ConeProgram& program, const ConeIterate& iterate) {
    for (Eigen::Index e = 0; e < program.edge.rows(); ++e) {
        EXPECT_EQ(iterate.s(0, e), program.limit[e]);
        EXPECT_LT(iterate.s.col(e).tail<3>().norm(), iterate.s(0, e));
        EXPECT_LT(iterate.z.col(e).tail<3>().norm(), iterate.z(0, e));
    }
}

class ConeInteriorPointFrom : public ::testing::TestWithParam<double> {};

TEST_P(ConeInteriorPointFrom, StartsInsideAndBalancedAndGetsBetter) {
    const InextensibleCase cloth = patch(5, 4, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(cloth.at_rest(), GetParam());
    ConeProgram program(cloth.model);
    program.set_predicted(predicted);
    ConeInteriorPoint method(program.edge, cloth.model.vertex_count);
    ConeIterate iterate;
    Report report;
    ASSERT_TRUE(method.start(program, iterate, report));
    expect_inside(program, iterate);
    const double force = iterate.z.cwiseAbs().maxCoeff();
    EXPECT_LT(imbalance(program, iterate), 1e-10 * force);

    const double first = iterate.mean_product();
    for (int k = 0; k < 8; ++k) {
        const double before = iterate.mean_product();
        ASSERT_TRUE(method.step(program, iterate, report));
        expect_inside(program, iterate);
        EXPECT_LT(iterate.mean_product(), before);
        EXPECT_LT(imbalance(program, iterate), 1e-10 * force);
    }
    EXPECT_LT(iterate.mean_product(), 1e-3 * first);
}

INSTANTIATE_TEST_SUITE_P(Noise, ConeInteriorPointFrom, ::testing::Values(1e-3, 0.02, 1.0, 100.0));

}  // namespace
}  // namespace toile::prior::test

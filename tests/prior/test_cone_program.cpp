#include <gtest/gtest.h>

#include "prior/cone_program.h"
#include "prior/cone_solver.h"
#include "tests/prior/inextensible_cases.h"
#include "tests/prior/paper_cone_program.h"

namespace toile::prior::test {
namespace {

TEST(ConeProgram, IsTheSameInAnyUnits) {
    InextensibleCase cloth = patch(4, 3, 0.02, 0.2);
    std::vector<double> predicted = with_noise(cloth.at_rest(), 0.005);
    ConeProgram in_metres(cloth.model);
    in_metres.set_predicted(predicted);
    cloth.model.edge_max_length *= 1000;
    cloth.model.target_stiffness *= 1e-3;
    for (double& x : predicted) x = 1000 * x + 1e6;
    ConeProgram in_millimetres(cloth.model);
    in_millimetres.set_predicted(predicted);
    EXPECT_LT((in_metres.limit - in_millimetres.limit).norm(), 1e-13);
    EXPECT_LT((in_metres.stiffness - in_millimetres.stiffness).norm(), 1e-13);
    EXPECT_LT((in_metres.edge_vector - in_millimetres.edge_vector).norm(), 1e-9);
    EXPECT_NEAR(in_metres.limit.mean(), 1.0, 1e-14);
    EXPECT_NEAR(in_metres.stiffness.mean(), 1.0, 1e-14);
}

TEST(ConeProgram, HasTheSolutionOfThePapersProgram) {
    InextensibleCase cloth = patch(3, 3, 0.02, 0.2);
    cloth.model.target_stiffness[4] = 2.5;
    const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.01);
    std::vector<double> position(predicted.size()), multiplier(cloth.model.edge.rows());
    InextensibilityOptions options;
    options.tolerance = 1e-10;
    const Report report = ConeSolver(cloth.model).project(predicted, position, multiplier, options);
    ASSERT_EQ(report.status, Status::converged);
    const PaperConeProgram paper(cloth.model, predicted, position, multiplier);

    // Equation 6, then s ∘ z = 0 and both in the cone.
    const double forces = paper.z.lpNorm<Eigen::Infinity>();
    EXPECT_LT((paper.a.transpose() * paper.y + paper.g.transpose() * paper.z + paper.c).lpNorm<Eigen::Infinity>(),
              1e-9 * forces);
    EXPECT_LT((paper.a * paper.x - paper.b).lpNorm<Eigen::Infinity>(), 1e-15);
    EXPECT_LT((paper.g * paper.x + paper.s - paper.h).lpNorm<Eigen::Infinity>(), 1e-15);
    EXPECT_LT((paper.product_matrix(paper.s) * paper.z).lpNorm<Eigen::Infinity>(), 1e-10 * forces);
    for (size_t k = 0; k + 1 < paper.cone_start.size(); ++k) {
        const Eigen::Index begin = paper.cone_start[k], size = paper.cone_start[k + 1] - begin - 1;
        EXPECT_LE(paper.s.segment(begin + 1, size).norm(), paper.s[begin] * (1 + 1e-9));
        EXPECT_LE(paper.z.segment(begin + 1, size).norm(), paper.z[begin] * (1 + 1e-9) + 1e-30);
    }
    // Strong duality: cᵀx = −bᵀy − hᵀz (Equations 4 and 5).
    EXPECT_NEAR(paper.c.dot(paper.x), -paper.b.dot(paper.y) - paper.h.dot(paper.z), 1e-9 * paper.c.dot(paper.x));
}

}  // namespace
}  // namespace toile::prior::test

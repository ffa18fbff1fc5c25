#include <gtest/gtest.h>

#include "prior/cone_polish.h"
#include "prior/cone_solver.h"
#include "tests/prior/inextensible_cases.h"

namespace toile::prior::test {
namespace {

TEST(ConePolish, ConvergesFromNearASolution) {
    const InextensibleCase cloth = patch(5, 4, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.01);
    std::vector<double> position(predicted.size()), multiplier(cloth.model.edge.rows());
    InextensibilityOptions options;
    options.tolerance = 1e-10;
    ASSERT_EQ(ConeSolver(cloth.model).project(predicted, position, multiplier, options).status, Status::converged);

    ConeProgram program(cloth.model);
    program.set_predicted(predicted);
    Eigen::VectorXd u(3 * cloth.model.vertex_count), lambda(cloth.model.edge.rows());
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = (position[i] - predicted[i]) / program.length_unit;
    for (Eigen::Index e = 0; e < lambda.size(); ++e) lambda[e] = multiplier[e] / program.force_unit();
    const Eigen::VectorXd exact_u = u, exact_lambda = lambda;

    for (bool by_largest : {false, true}) {
        SCOPED_TRACE(by_largest);
        const std::vector<double> noise = random_vector(static_cast<size_t>(u.size() + lambda.size()), 3);
        for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = exact_u[i] + 1e-5 * noise[i];
        for (Eigen::Index e = 0; e < lambda.size(); ++e)
            lambda[e] = std::max(0.0, exact_lambda[e] + 1e-5 * noise[u.size() + e]);
        ConeKkt kkt(program.edge, cloth.model.vertex_count);
        ConePolish polish(kkt, program, by_largest);
        Report report;
        for (int k = 0; k < 5; ++k) ASSERT_TRUE(polish.step(u, lambda, report));
        EXPECT_LT((u - exact_u).norm(), 1e-9 * exact_u.norm());
        EXPECT_LT((lambda - exact_lambda).norm(), 1e-9 * exact_lambda.norm());
        for (Eigen::Index e = 0; e < lambda.size(); ++e) EXPECT_EQ(lambda[e] == 0.0, exact_lambda[e] == 0.0);
    }
}

}  // namespace
}  // namespace toile::prior::test

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "cloth/error.h"
#include "prior/quasidefinite_ldl.h"

namespace toile::prior {
namespace {

/// [ P Bᵀ ; B −Q ] with P and Q positive definite, lower triangle; `tilt` moves its values and leaves its pattern.
SparseMatrix quasidefinite(int positive, int negative, double tilt = 0.0) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Eigen::Triplet<double>> entry;
    for (int i = 0; i < positive; ++i) {
        entry.emplace_back(i, i, 3.0 + tilt);
        if (i > 0) entry.emplace_back(i, i - 1, uniform(random));
    }
    for (int j = 0; j < negative; ++j) {
        entry.emplace_back(positive + j, positive + j, -1e-3);
        for (int k = 0; k < 3; ++k) entry.emplace_back(positive + j, (5 * j + 2 * k) % positive, uniform(random));
    }
    SparseMatrix matrix(positive + negative, positive + negative);
    matrix.setFromTriplets(entry.begin(), entry.end());
    return matrix;
}

void expect_solves(QuasidefiniteLdl& ldl, const SparseMatrix& matrix) {
    const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(matrix.rows(), -1.0, 2.0);
    Eigen::VectorXd x;
    ldl.solve(matrix.selfadjointView<Eigen::Lower>() * expected, x);
    EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm());
}

TEST(QuasidefiniteLdl, SolvesIndefiniteSystems) {
    const SparseMatrix matrix = quasidefinite(30, 12);
    QuasidefiniteLdl ldl(matrix);
    ASSERT_TRUE(ldl.factor(matrix));
    expect_solves(ldl, matrix);
    EXPECT_GE(ldl.factor_nonzeros(), matrix.nonZeros());
}

TEST(QuasidefiniteLdl, FactorsNewValuesWithOneAnalysis) {
    QuasidefiniteLdl ldl(quasidefinite(30, 12));
    for (double tilt : {0.0, 1.0, 5.0}) {
        const SparseMatrix matrix = quasidefinite(30, 12, tilt);
        ASSERT_TRUE(ldl.factor(matrix));
        expect_solves(ldl, matrix);
    }
}

TEST(QuasidefiniteLdl, SaysWhereThereIsNoFactor) {
    SparseMatrix matrix = quasidefinite(10, 3);
    QuasidefiniteLdl ldl(matrix);
    matrix.valuePtr()[2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(ldl.factor(matrix));
    std::fill_n(matrix.valuePtr(), matrix.nonZeros(), 0.0);
    EXPECT_FALSE(ldl.factor(matrix));
    EXPECT_TRUE(ldl.factor(quasidefinite(10, 3)));
}

TEST(QuasidefiniteLdl, RefusesAnotherPattern) {
    QuasidefiniteLdl ldl(quasidefinite(10, 3));
    EXPECT_THROW(ldl.factor(quasidefinite(10, 4)), Error);
    EXPECT_THROW(ldl.factor(quasidefinite(11, 2)), Error);
    Eigen::VectorXd x;
    EXPECT_THROW(ldl.solve(Eigen::VectorXd::Ones(5), x), Error);
}

}  // namespace
}  // namespace toile::prior

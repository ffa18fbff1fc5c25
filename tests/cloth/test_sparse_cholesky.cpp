#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "cloth/sparse_cholesky.h"

namespace toile {
namespace {

/// A path of vertices: identity springs between neighbours, so positive definite once a vertex is held.
BlockMatrix path(int vertices, double hold) {
    std::vector<std::pair<int, int>> pairs;
    for (int v = 1; v < vertices; ++v) pairs.emplace_back(v - 1, v);
    BlockMatrix matrix(vertices, pairs);
    for (int v = 1; v < vertices; ++v) {
        matrix.add_identity(v, v, 1.0);
        matrix.add_identity(v - 1, v - 1, 1.0);
        matrix.add_identity(v, v - 1, -1.0);
    }
    matrix.add_identity(0, 0, hold);
    return matrix;
}

TEST(SparseCholesky, SolvesAndSolvesAgainWithOtherValues) {
    const BlockMatrix first = path(50, 1.0), second = path(50, 7.0);
    SparseCholesky cholesky(first);
    for (const BlockMatrix* matrix : {&first, &second}) {
        ASSERT_TRUE(cholesky.factor(*matrix));
        const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(150, -1.0, 1.0);
        Eigen::VectorXd x, back;
        cholesky.solve(b, x);
        matrix->multiply(x, back);
        EXPECT_LT((back - b).norm(), 1e-10 * b.norm());
    }
}

TEST(SparseCholesky, SaysSoWhereAMatrixIsNotPositiveDefinite) {
    SparseCholesky cholesky(path(50, 1.0));
    EXPECT_FALSE(cholesky.factor(path(50, -1.0)));
    EXPECT_TRUE(cholesky.factor(path(50, 1.0))) << "and works again afterwards";
}

TEST(SparseCholesky, RefusesAnotherPattern) {
    SparseCholesky cholesky(path(50, 1.0));
    EXPECT_THROW(cholesky.factor(path(51, 1.0)), Error);
    BlockMatrix denser(50, {{0, 1}});
    EXPECT_THROW(cholesky.factor(denser), Error);
}

TEST(SparseCholesky, RefusesValuesThatAreNotFinite) {
    BlockMatrix matrix = path(50, 1.0);
    SparseCholesky cholesky(matrix);
    matrix.add_identity(3, 3, std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(cholesky.factor(matrix), Error);
}

TEST(SparseCholesky, RefusesARightHandSideOfAnotherSize) {
    const BlockMatrix matrix = path(50, 1.0);
    SparseCholesky cholesky(matrix);
    ASSERT_TRUE(cholesky.factor(matrix));
    Eigen::VectorXd x;
    EXPECT_THROW(cholesky.solve(Eigen::VectorXd::Zero(149), x), Error);
}

}  // namespace
}  // namespace toile

#include <gtest/gtest.h>

#include <cmath>

#include "cloth/block_matrix.h"
#include "cloth/error.h"

namespace toile {
namespace {

const std::vector<std::pair<int, int>> ring = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 1}, {2, 0}};

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
    for (int column = 0; column < matrix.size(); ++column) {
        for (int k = matrix.column_start()[column]; k < matrix.column_start()[column + 1]; ++k) {
            full(matrix.row()[k], column) = matrix.value()[k];
            full(column, matrix.row()[k]) = matrix.value()[k];
        }
    }
    return full;
}

Eigen::Matrix3d block(int seed) {
    Eigen::Matrix3d b;
    for (int i = 0; i < 9; ++i) b.data()[i] = std::sin(1.7 * seed + i);
    return b;
}

TEST(BlockMatrix, AddsWhatADenseMatrixWould) {
    BlockMatrix matrix(4, ring);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(12, 12);
    int seed = 0;
    for (const auto& [i, j] : {std::pair{0, 1}, {2, 1}, {3, 2}, {0, 3}, {0, 2}}) {
        matrix.add(i, j, block(seed));
        expected.block<3, 3>(3 * i, 3 * j) += block(seed);
        expected.block<3, 3>(3 * j, 3 * i) += block(seed).transpose();
        ++seed;
    }
    const Eigen::Matrix3d symmetric = block(9) + block(9).transpose();
    matrix.add(2, 2, symmetric);
    expected.block<3, 3>(6, 6) += symmetric;
    matrix.add_identity(3, 3, 2.0);
    expected.block<3, 3>(9, 9) += 2.0 * Eigen::Matrix3d::Identity();
    matrix.add_identity(1, 2, -0.5);
    expected.block<3, 3>(3, 6) -= 0.5 * Eigen::Matrix3d::Identity();
    expected.block<3, 3>(6, 3) -= 0.5 * Eigen::Matrix3d::Identity();
    EXPECT_LT((dense(matrix) - expected).norm(), 1e-14);

    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(12, -1, 2);
    Eigen::VectorXd y;
    matrix.multiply(x, y);
    EXPECT_LT((y - expected * x).norm(), 1e-13);
}

TEST(BlockMatrix, RowsRiseInEachColumn) {
    const BlockMatrix matrix(4, ring);
    for (int column = 0; column < matrix.size(); ++column) {
        EXPECT_EQ(matrix.row()[matrix.column_start()[column]], column);
        for (int k = matrix.column_start()[column] + 1; k < matrix.column_start()[column + 1]; ++k)
            EXPECT_LT(matrix.row()[k - 1], matrix.row()[k]);
    }
}

TEST(BlockMatrix, FixLeavesTheIdentity) {
    BlockMatrix matrix(4, ring);
    for (const auto& [i, j] : ring) matrix.add(i, j, block(i + j));
    for (int v = 0; v < 4; ++v) matrix.add_identity(v, v, 5.0);
    const Eigen::MatrixXd before = dense(matrix);
    matrix.fix(2);
    const Eigen::MatrixXd after = dense(matrix);
    Eigen::MatrixXd expected = before;
    expected.middleRows(6, 3).setZero();
    expected.middleCols(6, 3).setZero();
    expected.block<3, 3>(6, 6).setIdentity();
    EXPECT_EQ(after, expected);
}

TEST(BlockMatrix, RefusesPairsOutOfRange) {
    EXPECT_THROW(BlockMatrix(3, {{0, 3}}), Error);
    EXPECT_THROW(BlockMatrix(3, {{-1, 0}}), Error);
}

TEST(BlockMatrix, RefusesABlockOutsideItsGraph) {
    BlockMatrix matrix(4, ring);
    EXPECT_THROW(matrix.add(1, 3, Eigen::Matrix3d::Identity()), Error);
}

}  // namespace
}  // namespace toile

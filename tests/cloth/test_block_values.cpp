#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "cloth/block_values.h"

namespace toile {
namespace {

struct Fixture {
    BlockValues values{std::make_shared<const BlockSymbolic>(3, std::vector<std::pair<int, int>>{{0, 1}, {2, 1}})};
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(9, 9);

    Fixture() {
        for (int v = 0; v < 3; ++v) add(v, v, (4.0 + v) * Eigen::Matrix3d::Identity() + Eigen::Matrix3d::Ones());
        Eigen::Matrix3d skewed;
        skewed << 1, 2, 3, 4, 5, 6, 7, 8, 9;
        add(1, 0, skewed);
        add(2, 1, 0.5 * skewed);
    }
    void add(int i, int j, const Eigen::Matrix3d& block) {
        values.add(values.symbolic().slot(i, j), block);
        full.block<3, 3>(3 * i, 3 * j) += block;
        if (i != j) full.block<3, 3>(3 * j, 3 * i) += block.transpose();
    }
    Eigen::VectorXd product(const Eigen::VectorXd& x) const {
        Eigen::VectorXd y(9);
        values.multiply(x.data(), y.data());
        return y;
    }
};

TEST(BlockValues, MultipliesAsTheSymmetricMatrixItStandsFor) {
    const Fixture f;
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -1.0, 2.0);
    EXPECT_LT((f.product(x) - f.full * x).norm(), 1e-12);
}

TEST(BlockValues, AFixedVertexKeepsToItself) {
    Fixture f;
    f.values.fix({false, true, false});
    f.full.middleRows(3, 3).setZero();
    f.full.middleCols(3, 3).setZero();
    f.full.block<3, 3>(3, 3).setIdentity();
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -1.0, 2.0);
    EXPECT_LT((f.product(x) - f.full * x).norm(), 1e-12);
}

}  // namespace
}  // namespace toile

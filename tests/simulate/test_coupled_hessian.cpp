#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "simulate/coupled_hessian.h"

namespace toile::simulate {
namespace {

/// A chain of vertices, each with its neighbour; couplings then join its ends.
struct Chain {
    static constexpr int count = 12;
    std::shared_ptr<const BlockSymbolic> symbolic = std::make_shared<const BlockSymbolic>(count, pairs());
    CoupledHessian hessian{symbolic};

    static std::vector<std::pair<int, int>> pairs() {
        std::vector<std::pair<int, int>> list;
        for (int v = 0; v + 1 < count; ++v) list.emplace_back(v, v + 1);
        return list;
    }
    void fill() {
        for (int v = 0; v < count; ++v) hessian.own().add_identity(v, 4.0 + 0.1 * v);
        for (int v = 0; v + 1 < count; ++v) hessian.own().add_identity(symbolic->slot(v, v + 1), -1.0);
    }
    /// The residual of a solve, with the matrix as it is then.
    double residual() {
        const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * count, -1.0, 2.0);
        Eigen::VectorXd x = b, product(3 * count);
        EXPECT_TRUE(hessian.factor_and_solve(x.data()));
        hessian.values().multiply(x.data(), product.data());
        return (product - b).norm() / b.norm();
    }
};

const std::vector<std::array<int, 4>> ends = {{0, 1, 10, 11}}, middle = {{2, 3, 7, 8}}, none;

TEST(CoupledHessian, SolvesOnTheOwnGraph) {
    Chain f;
    f.hessian.couple(none, none);
    f.fill();
    f.hessian.finish();
    EXPECT_LT(f.residual(), 1e-12);
    EXPECT_EQ(&f.hessian.values(), &f.hessian.own());
}

TEST(CoupledHessian, CouplingsComeStayAndGo) {
    Chain f;
    for (int step = 0; step < 12; ++step) {  // long enough to be ordered anew
        f.hessian.couple(ends, middle);
        f.fill();
        f.hessian.finish();
        BlockValues& values = f.hessian.values();
        ASSERT_NE(&values, &f.hessian.own());
        const int slot = values.symbolic().slot(11, 0);
        values.add_identity(slot, -0.7);
        EXPECT_NO_THROW(values.symbolic().slot(2, 8)) << "what is likely has room";
        EXPECT_LT(f.residual(), 1e-12) << step;
    }
    f.hessian.couple(none, none);
    f.fill();
    f.hessian.finish();
    EXPECT_EQ(&f.hessian.values(), &f.hessian.own());
    EXPECT_LT(f.residual(), 1e-12);
}

TEST(CoupledHessian, TellsWhatIsNotPositiveDefinite) {
    Chain f;
    f.hessian.couple(ends, none);
    f.fill();
    f.hessian.finish();
    f.hessian.values().add_identity(3, -100.0);
    Eigen::VectorXd x = Eigen::VectorXd::Ones(3 * Chain::count);
    EXPECT_FALSE(f.hessian.factor_and_solve(x.data()));
}

}  // namespace
}  // namespace toile::simulate

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <cstdlib>

#include "simulate/trust_region.h"

namespace toile::simulate {
namespace {

/// g·d + ½ d·H d in four points' coordinates, with P as preconditioner.
struct Model {
    Eigen::MatrixXd hessian, preconditioner;
    Positions gradient;

    explicit Model(double smallest) {
        std::srand(5);
        const Eigen::MatrixXd random = Eigen::MatrixXd::Random(12, 12);
        const Eigen::MatrixXd basis = Eigen::HouseholderQR<Eigen::MatrixXd>(random).householderQ();
        const Eigen::VectorXd value = Eigen::VectorXd::LinSpaced(12, smallest, 3.0);
        hessian = basis * value.asDiagonal() * basis.transpose();
        preconditioner = basis * (value.array().max(0.2) + 0.3).matrix().asDiagonal() * basis.transpose();
        gradient = Positions::Random(4, 3);
    }
    static Eigen::Map<const Eigen::VectorXd> flat(const Positions& rows) { return {rows.data(), 12}; }
    static Positions rows(const Eigen::VectorXd& flat) { return Eigen::Map<const Positions>(flat.data(), 4, 3); }
    Positions newton() const { return rows(-preconditioner.llt().solve(flat(gradient))); }
    double length(const Positions& d) const { return std::sqrt(flat(d).dot(preconditioner * flat(d))); }
    double decrease(const Positions& d) const {
        return -flat(gradient).dot(flat(d)) - 0.5 * flat(d).dot(hessian * flat(d));
    }
    Positions improve(TrustRegion& region) const {
        Positions d = newton();
        region.improve(
            gradient, [&](const Positions& in, Positions& out) { out = rows(hessian * flat(in)); },
            [&](const Positions& in, Positions& out) { out = rows(preconditioner.llt().solve(flat(in))); }, d);
        return d;
    }
};

TEST(TrustRegion, NearsTheMinimumOfAConvexModelWithinTheRegion) {
    const Model model(0.1);
    TrustRegion region;
    for (int k = 0; k < 4; ++k) {  // makes room
        model.improve(region);
        region.learn(1.0, region.decrease());
    }
    const Positions d = model.improve(region);
    EXPECT_FALSE(region.at_rim());
    EXPECT_NEAR(model.length(d), region.length(), 1e-12);
    EXPECT_NEAR(model.decrease(d), region.decrease(), 1e-12);
    const Positions best = Model::rows(-model.hessian.llt().solve(Model::flat(model.gradient)));
    EXPECT_GT(region.decrease(), 0.85 * model.decrease(best));
    EXPECT_GT(region.decrease(), model.decrease(model.newton()));
}

TEST(TrustRegion, GoesToTheRimWhereTheModelCurvesDownwards) {
    const Model model(-1.0);
    TrustRegion region;
    const Positions d = model.improve(region);
    EXPECT_TRUE(region.at_rim());
    EXPECT_NEAR(model.length(d), region.radius(), 1e-12 * region.radius());
    EXPECT_NEAR(model.decrease(d), region.decrease(), 1e-12);
    EXPECT_GT(region.decrease(), 0.0);
    EXPECT_LT(Model::flat(model.gradient).dot(Model::flat(d)), 0.0) << "downhill";
}

TEST(TrustRegion, TheRadiusFollowsWhatTheModelIsWorth) {
    const Model model(-1.0);
    TrustRegion region;
    model.improve(region);
    const double first = region.radius();
    region.learn(1.0, region.decrease());
    EXPECT_EQ(region.radius(), 2.0 * first);
    EXPECT_NEAR(model.length(model.improve(region)), 2.0 * first, 1e-9 * first);
    region.learn(1.0, 0.1 * region.decrease());
    EXPECT_EQ(region.radius(), first);
    model.improve(region);
    region.learn(0.25, region.decrease());
    EXPECT_EQ(region.radius(), 0.25 * first);
    EXPECT_NEAR(model.length(model.improve(region)), 0.25 * first, 1e-9 * first) << "shorter than Newton's step";
    region.reset();
    model.improve(region);
    EXPECT_EQ(region.radius(), first);
}

}  // namespace
}  // namespace toile::simulate

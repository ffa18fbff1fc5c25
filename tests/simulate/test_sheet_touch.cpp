#include <gtest/gtest.h>

#include <algorithm>

#include "simulate/sheet_touch.h"
#include "tests/simulate/two_layers.h"

namespace toile::simulate {
namespace {

constexpr double thickness = 0.002, h = 5e-4;

struct Fixture {
    ClothMesh mesh;
    Topology topology;
    Eigen::VectorXd inverse_mass;
    Positions before, nothing;

    explicit Fixture(double gap)
        : mesh(test::two_layers(gap)),
          topology(build_topology(mesh.triangle)),
          inverse_mass(mesh.mass.cwiseInverse()),
          before(test::crumpled(mesh.rest_position, 0.05 * gap)),
          nothing(Positions::Zero(before.rows(), 3)) {}
    SheetTouches touches(double friction = 0.0) const {
        return {mesh, topology, {.thickness = thickness, .friction = friction}, inverse_mass};
    }
    /// The upper layer moved.
    Positions moved(const Eigen::RowVector3d& by) const {
        Positions now = before;
        now.bottomRows(now.rows() / 2).rowwise() += by;
        return now;
    }
};

double gap_of(const SheetPush& push, const Positions& x) {
    Eigen::Vector3d apart = x.row(push.vertex).transpose();
    for (int k = 0; k < 3; ++k) apart -= push.weight[k] * x.row(push.other[k]).transpose();
    return push.normal.dot(apart);
}

void apply(const SheetPush& push, double correction, Positions& x) {
    x.row(push.vertex) += correction * push.vertex_share * push.normal.transpose();
    for (int k = 0; k < 3; ++k)
        x.row(push.other[k]) -= correction * push.other_share * push.weight[k] * push.normal.transpose();
}

TEST(SheetTouches, LeavesAloneWhatStaysApart) {
    const Fixture f(0.003);
    SheetTouches touches = f.touches();
    EXPECT_TRUE(touches.pushes(f.before, f.before, f.nothing, h).empty());
    EXPECT_TRUE(touches.pushes(f.before, f.moved({0, -0.0001, 0}), f.nothing, h).empty());
}

TEST(SheetTouches, EachPushBringsItsPairToItsGap) {
    const Fixture f(0.0025);
    SheetTouches touches = f.touches();
    const Positions now = f.moved({0, -0.001, 0});
    const auto pushes = touches.pushes(f.before, now, f.nothing, h);
    ASSERT_FALSE(pushes.empty());
    int edges = 0;
    for (const SheetPush& push : pushes) {
        EXPECT_NEAR(push.weight[0] + push.weight[1] + push.weight[2], 1.0, 1e-12);
        edges += std::min({push.weight[0], push.weight[1], push.weight[2]}) < 0.0;
        const double lacking = push.gap - gap_of(push, now);
        EXPECT_GT(lacking, 0.0);
        Positions corrected = now;
        apply(push, lacking, corrected);
        EXPECT_NEAR(gap_of(push, corrected), push.gap, 1e-12);
    }
    EXPECT_GT(edges, 0) << "edges off edges are among them";
}

TEST(SheetTouches, KeepsMomentumWhereMassesAreEqual) {
    Fixture f(0.0025);
    f.inverse_mass.setConstant(1e4);
    SheetTouches touches = f.touches();
    const Positions now = f.moved({0, -0.001, 0});
    for (const SheetPush& push : touches.pushes(f.before, now, f.nothing, h)) {
        Positions corrected = now;
        apply(push, 0.001, corrected);
        EXPECT_GT((corrected - now).norm(), 1e-5);
        EXPECT_LT((corrected - now).colwise().sum().norm(), 1e-15);
    }
}

TEST(SheetTouches, TakesApartAtABoundedSpeed) {
    const Fixture f(0.001);
    SheetTouches touches = f.touches();
    const auto pushes = touches.pushes(f.before, f.before, f.nothing, h);
    ASSERT_FALSE(pushes.empty());
    int recovering = 0;
    for (const SheetPush& push : pushes) {
        if (!push.recovering) continue;
        ++recovering;
        EXPECT_GT(push.gap, gap_of(push, f.before));
        EXPECT_LT(push.gap - gap_of(push, f.before), 2.0 * 0.1 * h + 1e-12) << "a weight is at least a half";
    }
    EXPECT_GT(recovering, 0);
}

TEST(SheetTouches, WhatIsHeldOrSupportedDoesNotGiveWay) {
    Fixture f(0.0025);
    f.inverse_mass.head(f.before.rows() / 2).setZero();  // the lower layer
    SheetTouches held = f.touches();
    const Positions now = f.moved({0, -0.001, 0});
    const auto moves_upper_only = [&](const std::vector<SheetPush>& pushes) {
        ASSERT_FALSE(pushes.empty());
        for (const SheetPush& push : pushes) {
            Positions corrected = now;
            apply(push, 0.001, corrected);
            EXPECT_EQ((corrected - now).topRows(now.rows() / 2).norm(), 0.0);
        }
    };
    moves_upper_only(held.pushes(f.before, now, f.nothing, h));
    const Fixture free(0.0025);
    SheetTouches touches = free.touches();
    Positions ground = f.nothing;
    ground.topRows(ground.rows() / 2).col(1).setOnes();
    int given = 0;
    for (const SheetPush& push : touches.pushes(f.before, now, ground, h)) {
        Positions corrected = now;
        apply(push, 0.001, corrected);
        given += (corrected - now).topRows(now.rows() / 2).col(1).minCoeff() < 0.0;
    }
    EXPECT_EQ(given, 0) << "nothing of the lower layer is pressed into the ground";
}

TEST(SheetTouches, FrictionTakesWhatCoulombLets) {
    const Fixture f(0.002);
    const Positions now = f.moved({0.0005, -0.0004, 0.0});
    SheetTouches smooth = f.touches(0.0), rough = f.touches(0.5);
    for (const SheetPush& push : smooth.pushes(f.before, now, f.nothing, h)) EXPECT_EQ(push.grip, 0.0);
    int slides = 0, sticks = 0;
    for (const Positions& to : {now, f.moved({0.0, -0.0004, 0.0})})
        for (const SheetPush& push : rough.pushes(f.before, to, f.nothing, h)) {
            Eigen::Vector3d way = (to.row(push.vertex) - f.before.row(push.vertex)).transpose();
            for (int k = 0; k < 3; ++k)
                way -= push.weight[k] * (to.row(push.other[k]) - f.before.row(push.other[k])).transpose();
            const double slip = (way - push.normal * push.normal.dot(way)).norm();
            const double lacking = std::max(0.0, push.gap - gap_of(push, to));
            const double share = slip > 0.5 * lacking ? 0.5 * lacking / slip : 1.0;
            EXPECT_NEAR(push.grip, share, 1e-9);
            ++(share < 1.0 ? slides : sticks);
        }
    EXPECT_GT(slides, 0);
    EXPECT_GT(sticks, 0);
}

TEST(SheetTouches, FindsTheSameWhateverItWasAskedBefore) {
    const Fixture f(0.0025);
    const Positions now = f.moved({0.0003, -0.0008, 0});
    SheetTouches fresh = f.touches(), used = f.touches();
    for (int k = 1; k <= 12; ++k)
        used.pushes(f.moved({0.0, 0.0002 * k, 0.0}), f.moved({0.0, 0.0002 * k - 0.0001, 0.0}), f.nothing, h);
    const auto one = fresh.pushes(f.before, now, f.nothing, h), other = used.pushes(f.before, now, f.nothing, h);
    ASSERT_EQ(one.size(), other.size());
    for (size_t k = 0; k < one.size(); ++k) {
        EXPECT_EQ(one[k].vertex, other[k].vertex);
        EXPECT_EQ(one[k].gap, other[k].gap);
    }
}

}  // namespace
}  // namespace toile::simulate

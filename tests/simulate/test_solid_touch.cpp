#include <gtest/gtest.h>

#include "simulate/solid_touch.h"

namespace toile::simulate {
namespace {

constexpr double thickness = 0.002, mass = 1e-3, h = 1e-3;

/// The half space below y = 0, which counts how often it is asked and can move.
class Ground final : public Obstacle {
  public:
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        ++asked;
        return {point.y() - offset.y(), Eigen::Vector3d::UnitY()};
    }
    Eigen::Vector3d to_world(const Eigen::Vector3d& local, int /*piece*/) const override { return local + offset; }
    Eigen::Vector3d to_local(const Eigen::Vector3d& world, int /*piece*/) const override { return world - offset; }
    mutable int asked = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// One vertex over the ground.
struct Fixture {
    std::vector<ContactPoint> points{{0, -1, 0, 1e-4}};
    Ground ground;
    Contact contact;
    SolidTouches touches;

    explicit Fixture(double friction = 0.5) : contact({thickness, friction}, 1e4, points, ground), touches(contact, 1) {
        contact.begin_step(Positions::Zero(1, 3));
    }
    std::optional<SolidPush> push(double before, double now, double slip = 0.0) {
        return touches.push(0, {{0.0, before, 0.0}, {slip, now, 0.0}, mass, h});
    }
};

TEST(SolidTouches, LeavesAloneWhatStaysClear) {
    Fixture f;
    EXPECT_FALSE(f.push(0.01, 0.009));
    EXPECT_EQ(f.ground.asked, 1);
    EXPECT_FALSE(f.push(0.009, 0.008)) << "it cannot have come near";
    EXPECT_EQ(f.ground.asked, 1);
}

TEST(SolidTouches, TakesAVertexToTheThickness) {
    Fixture f;
    const auto push = f.push(0.003, 0.0015);
    ASSERT_TRUE(push);
    EXPECT_EQ(push->normal, Eigen::Vector3d::UnitY());
    EXPECT_NEAR(push->move, 0.0005, 1e-15);
    EXPECT_FALSE(push->recovering);
}

TEST(SolidTouches, TakesBackAtABoundedSpeed) {
    Fixture f;
    const auto push = f.push(-0.01, -0.0101);
    ASSERT_TRUE(push);
    EXPECT_TRUE(push->recovering);
    EXPECT_NEAR(push->move, 0.0001 + 0.5 * h, 1e-15);
}

TEST(SolidTouches, SeesAPlaneUntilTheVertexHasMoved) {
    Fixture f;
    f.push(0.0021, 0.00195);
    const auto push = f.push(0.00195, 0.0019);
    EXPECT_EQ(f.ground.asked, 1);
    ASSERT_TRUE(push);
    EXPECT_NEAR(push->move, 0.0001, 1e-15) << "to the thickness: the speed it takes is within the bound";
    f.push(0.0019, 0.0017);
    EXPECT_EQ(f.ground.asked, 2) << "further than a tenth of the thickness";
    f.push(0.0019, 0.00171);
    EXPECT_EQ(f.ground.asked, 3) << "too deep";
    f.push(0.002, 0.0019);
    f.touches.forget_distances();
    f.push(0.002, 0.0019);
    EXPECT_EQ(f.ground.asked, 4) << "the third look-up is forgotten";
}

TEST(SolidTouches, FrictionTakesWhatCoulombLets) {
    Fixture f(0.5);
    const auto first = f.push(0.002, 0.0016, 0.001);  // presses by 0.4 mm, slips 1 mm
    ASSERT_TRUE(first);
    EXPECT_NEAR(first->grip, 0.5 * 0.4, 1e-12);
    f.touches.weigh(0, 4e-4, 1e-4);  // of the slip of before, a fifth was taken
    const auto second = f.push(0.002, 0.0016, 0.001);
    ASSERT_TRUE(second);
    EXPECT_NEAR(second->grip, 0.5 * 4e-4 / (1e-4 / first->grip), 1e-12);
    Fixture smooth(0.0);
    EXPECT_EQ(smooth.push(0.002, 0.0016, 0.001)->grip, 0.0);
}

TEST(SolidTouches, TheSurfaceTakesAlong) {
    Fixture f;
    Positions x(1, 3);
    x << 0.0, 0.002, 0.0;
    f.touches.tie(x);
    f.ground.offset = {0.01, 0.0, 0.0};
    f.touches.take_surface_velocities(x, 0.1);
    EXPECT_NEAR(f.push(0.002, 0.0016)->along.x(), 0.1, 1e-12);
    f.touches.rest_surface();
    EXPECT_EQ(f.push(0.002, 0.0016)->along.norm(), 0.0);
}

}  // namespace
}  // namespace toile::simulate

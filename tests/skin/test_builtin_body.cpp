#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "skin/anatomy.h"
#include "skin/builtin_body.h"
#include "skin/skinning.h"

namespace toile::skin {
namespace {

void expect_closed_genus_zero(const Body& body) {
    const Topology topology = build_topology(body.triangle);
    EXPECT_EQ(topology.non_manifold_edge, -1);
    EXPECT_EQ((topology.edge_triangle.array() < 0).count(), 0) << "boundary edges";
    EXPECT_EQ(body.vertex_count() - topology.edge.rows() + body.triangle.rows(), 2) << "Euler characteristic";
    const std::vector<int> component = connected_components(body.triangle, body.vertex_count());
    EXPECT_EQ(*std::max_element(component.begin(), component.end()), 0) << "components";
}

/// Volume of the cone from `apex` over the triangles whose centroid at rest lies within `radius` of `center`.
double volume_about(const Body& body, const Positions& position, const Eigen::Vector3d& center, double radius,
                    const Eigen::Vector3d& apex) {
    double six_volumes = 0.0;
    for (Eigen::Index f = 0; f < body.triangle.rows(); ++f) {
        const auto corner = [&](const Positions& p, int c) -> Eigen::Vector3d { return p.row(body.triangle(f, c)); };
        const Eigen::Vector3d at_rest =
            (corner(body.rest_position, 0) + corner(body.rest_position, 1) + corner(body.rest_position, 2)) / 3.0;
        if ((at_rest - center).norm() > radius) continue;
        six_volumes += (corner(position, 0) - apex).dot((corner(position, 1) - apex).cross(corner(position, 2) - apex));
    }
    return six_volumes / 6.0;
}

/// Girth of the section of the posed surface across the left upper arm, by the convex hull's mean width (Cauchy).
double upper_arm_girth(const Body& body, const Positions& position, const Pose& pose) {
    const auto joint = forward_kinematics(body, pose);
    const Eigen::Vector3d shoulder = joint[body.role[Role::left_upper_arm]].topRightCorner<3, 1>();
    const Eigen::Vector3d elbow = joint[body.role[Role::left_lower_arm]].topRightCorner<3, 1>();
    const Eigen::Vector3d along = (elbow - shoulder).normalized();
    const Eigen::Vector3d side = along.unitOrthogonal(), front = along.cross(side);
    const Eigen::Vector3d middle = shoulder + 0.5 * (elbow - shoulder);
    constexpr int directions = 36;
    double girth = 0.0;
    for (int i = 0; i < directions; ++i) {
        const double angle = M_PI * i / directions;
        const Eigen::Vector3d direction = std::cos(angle) * side + std::sin(angle) * front;
        double low = 1.0, high = -1.0;
        for (Eigen::Index v = 0; v < position.rows(); ++v) {
            const Eigen::Vector3d offset = position.row(v).transpose() - middle;
            if (std::abs(offset.dot(along)) > 0.012 || offset.norm() > 0.1) continue;
            low = std::min(low, offset.dot(direction));
            high = std::max(high, offset.dot(direction));
        }
        girth += M_PI * (high - low) / directions;
    }
    return girth;
}

/// Coarser than the default, because every test makes its own.
class BuiltinBody : public testing::Test {
  protected:
    static void SetUpTestSuite() { body_ = new Body(make_builtin_body({.voxel = 0.02})); }
    static void TearDownTestSuite() {
        delete body_;
        body_ = nullptr;
    }
    static const Body& body() { return *body_; }
    static Eigen::Vector3d joint(Role role) { return body().joint[body().role[role]].bind.topRightCorner<3, 1>(); }
    static Pose with_arms(double raise) {
        RoleAngles angles;
        for (const Role role : {Role::left_upper_arm, Role::right_upper_arm}) angles.angle[role] = {raise, 0, 0};
        return pose_from_angles(body(), angles);
    }

  private:
    static Body* body_;
};
Body* BuiltinBody::body_ = nullptr;

TEST_F(BuiltinBody, IsClosedAndWoundOutwards) {
    expect_closed_genus_zero(body());
    const double volume = volume_about(body(), body().rest_position, {0, 0, 0}, 10.0, {0, 0, 0});
    EXPECT_GT(volume, 0.055);
    EXPECT_LT(volume, 0.085);
}

TEST_F(BuiltinBody, StandsOnTheFloor) {
    EXPECT_NEAR(body().rest_position.col(1).minCoeff(), 0.0, 1e-9);
    EXPECT_NEAR(body().rest_position.col(1).maxCoeff(), 1.75, 1e-9);
    EXPECT_NEAR(body().rest_position.col(0).minCoeff(), -body().rest_position.col(0).maxCoeff(), 2e-3);
}

TEST_F(BuiltinBody, HasEveryRoleByItsName) {
    EXPECT_TRUE(body().role.missing().empty());
    for (int role = 0; role < role_count; ++role)
        EXPECT_EQ(body().joint[body().role[static_cast<Role>(role)]].name, role_name(static_cast<Role>(role)));
    EXPECT_EQ(body().joint[0].parent, -1);
    EXPECT_EQ(body().role[Role::pelvis], 0);
}

TEST_F(BuiltinBody, JointsMirrorEachOther) {
    const std::pair<Role, Role> pairs[] = {{Role::left_clavicle, Role::right_clavicle},
                                           {Role::left_upper_arm, Role::right_upper_arm},
                                           {Role::left_lower_arm, Role::right_lower_arm},
                                           {Role::left_hand, Role::right_hand},
                                           {Role::left_upper_leg, Role::right_upper_leg},
                                           {Role::left_lower_leg, Role::right_lower_leg},
                                           {Role::left_foot, Role::right_foot}};
    for (const auto& [left, right] : pairs) {
        const Eigen::Vector3d a = joint(left), b = joint(right);
        EXPECT_GT(a.x(), 0.0);
        EXPECT_EQ(a, Eigen::Vector3d(-b.x(), b.y(), b.z()));
    }
    for (const Role middle : {Role::pelvis, Role::spine, Role::chest, Role::neck, Role::head})
        EXPECT_EQ(joint(middle).x(), 0.0);
}

TEST_F(BuiltinBody, ArmsHangHalfwayDown) {
    EXPECT_NEAR(bind_angles(body(), Role::left_upper_arm)[0], -M_PI / 4, 0.05);
    EXPECT_NEAR(bind_angles(body(), Role::right_upper_arm)[0], -M_PI / 4, 0.05);
}

TEST_F(BuiltinBody, WeightsAreFewAndSumToOne) {
    const SkinWeights& weight = body().weight;
    ASSERT_EQ(weight.offset.size(), static_cast<size_t>(body().vertex_count()) + 1);
    for (int v = 0; v < body().vertex_count(); ++v) {
        EXPECT_LE(weight.offset[v + 1] - weight.offset[v], 4);
        double sum = 0.0;
        for (int w = weight.offset[v]; w < weight.offset[v + 1]; ++w) {
            EXPECT_GT(weight.value[w], 0.0);
            sum += weight.value[w];
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
    }
}

TEST_F(BuiltinBody, WeightsChangeSmoothlyOverTheSurface) {
    Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(body().vertex_count(), role_count);
    for (int v = 0; v < body().vertex_count(); ++v)
        for (int w = body().weight.offset[v]; w < body().weight.offset[v + 1]; ++w)
            weight(v, body().weight.joint[w]) = body().weight.value[w];
    const Edges edge = build_topology(body().triangle).edge;
    double steepest = 0.0;
    for (Eigen::Index e = 0; e < edge.rows(); ++e) {
        const int a = edge(e, 0), b = edge(e, 1);
        const double jump = (weight.row(a) - weight.row(b)).cwiseAbs().maxCoeff();
        steepest = std::max(steepest, jump / (body().rest_position.row(a) - body().rest_position.row(b)).norm());
    }
    EXPECT_LT(steepest, 1.0 / 0.04) << "a weight may go from none to all within four centimetres, no sooner";
}

TEST_F(BuiltinBody, ShouldersKeepTheirVolumeFromHangingToOverhead) {
    const Eigen::Vector3d shoulder = joint(Role::left_upper_arm);
    const Pose rest = Pose::Zero(body().joint_count(), 3);
    const double volume = volume_about(body(), body().rest_position, {0, 0, 0}, 10.0, {0, 1, 0});
    const double girth = upper_arm_girth(body(), body().rest_position, rest);
    EXPECT_NEAR(girth, 0.30, 0.04);
    for (const SkinningMethod method : {SkinningMethod::linear, SkinningMethod::dual_quaternion})
        for (const double raise : {-1.4, -0.4, 0.0, 0.7, 1.5}) {
            const Pose pose = with_arms(raise);
            const Positions posed = skin_positions(body(), pose, method);
            const double now = volume_about(body(), posed, {0, 0, 0}, 10.0, {0, 1, 0});
            EXPECT_GT(now, 0.96 * volume) << "raise " << raise;
            EXPECT_LT(now, 1.12 * volume) << "raise " << raise;
            EXPECT_GT(upper_arm_girth(body(), posed, pose), 0.9 * girth) << "raise " << raise;
            const double shoulder_before = volume_about(body(), body().rest_position, shoulder, 0.14, shoulder);
            const double shoulder_now = volume_about(
                body(), posed, shoulder, 0.14,
                forward_kinematics(body(), pose)[body().role[Role::left_upper_arm]].topRightCorner<3, 1>());
            EXPECT_GT(shoulder_now, 0.75 * shoulder_before) << "raise " << raise;
        }
}

TEST(MakeBuiltinBody, HasTheRightSizeByDefault) {
    const Body body = make_builtin_body({});
    EXPECT_GE(body.vertex_count(), 8000);
    EXPECT_LE(body.vertex_count(), 15000);
    expect_closed_genus_zero(body);
}

TEST(MakeBuiltinBody, GivesTheSameBytesEveryTime) {
    const BuiltinBodyOptions coarse{.voxel = 0.03};
    const Body a = make_builtin_body(coarse), b = make_builtin_body(coarse);
    ASSERT_EQ(a.vertex_count(), b.vertex_count());
    EXPECT_EQ(std::memcmp(a.rest_position.data(), b.rest_position.data(), sizeof(double) * a.rest_position.size()), 0);
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.weight.offset, b.weight.offset);
    EXPECT_EQ(a.weight.joint, b.weight.joint);
    EXPECT_EQ(a.weight.value, b.weight.value);
}

TEST(MakeBuiltinBody, HoldsTogetherOverTheRangeOfItsOptions) {
    for (const double girth : {0.7, 1.4})
        for (const double height : {1.2, 2.2}) {
            const Body body = make_builtin_body({.height = height, .girth = girth, .voxel = 0.02 * height / 1.75});
            expect_closed_genus_zero(body);
            EXPECT_NEAR(body.rest_position.col(1).maxCoeff(), height, 1e-9);
            RoleAngles hanging;
            hanging.angle[Role::left_upper_arm] = {-1.4, 0, 0};
            const Pose pose = pose_from_angles(body, hanging);
            const Positions posed = skin_positions(body, pose, SkinningMethod::linear);
            const auto edge = build_topology(body.triangle).edge;
            for (Eigen::Index e = 0; e < edge.rows(); ++e) {
                const auto length = [&](const Positions& p) { return (p.row(edge(e, 0)) - p.row(edge(e, 1))).norm(); };
                EXPECT_LT(length(posed), 2.0 * length(body.rest_position) + 0.01) << "a vertex left behind";
            }
        }
}

TEST(MakeBuiltinBody, RefusesOptionsOutOfRange) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make_builtin_body({.height = 1.1}), Error);
    EXPECT_THROW(make_builtin_body({.height = 2.3}), Error);
    EXPECT_THROW(make_builtin_body({.height = nan}), Error);
    EXPECT_THROW(make_builtin_body({.girth = 0.6}), Error);
    EXPECT_THROW(make_builtin_body({.girth = 1.5}), Error);
    EXPECT_THROW(make_builtin_body({.voxel = 0.007}), Error);
    EXPECT_THROW(make_builtin_body({.voxel = 0.031}), Error);
}

}  // namespace
}  // namespace toile::skin

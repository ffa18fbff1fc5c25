#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/body_measure.h"
#include "pattern/settle.h"
#include "pattern/tshirt.h"
#include "skin/anatomy.h"
#include "skin/builtin_body.h"
#include "skin/rigged_body.h"
#include "skin/skinning.h"
#include "skin/surface_query.h"
#include "tests/pattern/slow_build.h"

namespace toile::pattern {
namespace {

using skin::Role;
using testing::HasSubstr;

/// The body with its arms at `raise` [rad] from the horizontal as its neutral pose.
skin::Body standing(const skin::Body& body, double raise) {
    skin::RoleAngles angles;
    angles.angle[Role::left_upper_arm] = {raise, 0, 0};
    angles.angle[Role::right_upper_arm] = {raise, 0, 0};
    const skin::Pose pose = skin::pose_from_angles(body, angles);
    skin::Body moved = body;
    moved.rest_position = skin::skin_positions(body, pose, skin::SkinningMethod::linear);
    const auto bind = skin::forward_kinematics(body, pose);
    for (int j = 0; j < moved.joint_count(); ++j) moved.joint[j].bind = bind[j];
    return moved;
}

Eigen::RowVector3d panel_middle(const Garment& shirt, int panel) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    int corners = 0;
    for (int f = 0; f < shirt.mesh.triangle_count(); ++f) {
        if (shirt.triangle_panel[f] != panel) continue;
        for (int k = 0; k < 3; ++k, ++corners) sum += shirt.mesh.rest_position.row(shirt.mesh.triangle(f, k));
    }
    return sum / corners;
}

/// All that must hold of a shirt on its body.
void expect_wearable(const Garment& shirt, const skin::Body& body) {
    const ClothMesh& mesh = shirt.mesh;
    EXPECT_NO_THROW(check_cloth_mesh(mesh, ""));
    EXPECT_EQ(boundary_loops(mesh.triangle).size(), 4u);
    EXPECT_THAT(shirt.panel_name, testing::ElementsAre("front", "back", "left sleeve", "right sleeve"));
    const skin::SurfaceQuery query(body.triangle, body.rest_position);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
        for (int k = 0; k < 3; ++k) {
            middle += mesh.rest_position.row(mesh.triangle(f, k)) / 3.0;
            EXPECT_GT(query.nearest(mesh.rest_position.row(mesh.triangle(f, k))).signed_distance, 0.005);
        }
        EXPECT_GT(query.nearest(middle.transpose()).signed_distance, 0.004);
        const auto p = mesh.pattern_triangle.row(f);
        const Eigen::RowVector2d u = mesh.pattern_position.row(p[1]) - mesh.pattern_position.row(p[0]);
        const Eigen::RowVector2d v = mesh.pattern_position.row(p[2]) - mesh.pattern_position.row(p[0]);
        EXPECT_GT(u.x() * v.y() - u.y() * v.x(), 0.0);
    }
    const Edges edge = build_topology(mesh.triangle).edge;
    const Eigen::VectorXd rest = pattern_edge_lengths(mesh);
    for (int e = 0; e < edge.rows(); ++e) {
        const double stretch =
            (mesh.rest_position.row(edge(e, 0)) - mesh.rest_position.row(edge(e, 1))).norm() / rest[e];
        EXPECT_LT(stretch, 1.5);
        EXPECT_GT(stretch, 0.6);
    }
    // Front in front, left at the left, outside outside.
    EXPECT_GT(panel_middle(shirt, 0).z(), panel_middle(shirt, 1).z() + 0.1);
    EXPECT_GT(panel_middle(shirt, 2).x(), panel_middle(shirt, 0).x() + 0.15);
    EXPECT_LT(panel_middle(shirt, 3).x(), panel_middle(shirt, 0).x() - 0.15);
    // Below the arms a sleeve may be nearer to the trunk than to its arm.
    const Positions normal = vertex_normals(mesh.triangle, mesh.rest_position);
    int inwards = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const auto nearest = query.nearest(mesh.rest_position.row(v));
        inwards += normal.row(v).dot(mesh.rest_position.row(v) - nearest.position.transpose()) < 0.0;
    }
    EXPECT_LT(inwards, 0.05 * mesh.vertex_count());
}

TEST(Tshirt, fits_the_built_in_body_in_its_A_pose) {
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    expect_wearable(make_tshirt(body, {.edge_length = 0.04}), body);
}

TEST(Tshirt, fits_a_T_pose) {
    TOILE_SKIP_IN_SLOW_BUILD();
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    const skin::Body spread = standing(body, 0.0);
    expect_wearable(make_tshirt(spread, {.edge_length = 0.035}), spread);
}

TEST(Tshirt, fits_a_body_that_is_not_closed) {
    TOILE_SKIP_IN_SLOW_BUILD();
    skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    Triangles headless(body.triangle.rows(), 3);
    int count = 0;
    for (int f = 0; f < body.triangle.rows(); ++f)
        if (body.rest_position(body.triangle(f, 0), 1) < 1.6) headless.row(count++) = body.triangle.row(f);
    body.triangle = headless.topRows(count).eval();
    ASSERT_FALSE(boundary_loops(body.triangle).empty());
    expect_wearable(make_tshirt(body, {.edge_length = 0.045}), body);
}

TEST(Tshirt, follows_its_options) {
    TOILE_SKIP_IN_SLOW_BUILD();
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    const Garment plain = make_tshirt(body, {.edge_length = 0.04});
    const Garment wide = make_tshirt(body, {.edge_length = 0.04, .ease = 0.4});
    const Garment long_one = make_tshirt(body, {.edge_length = 0.04, .body_length = 0.9, .sleeve_length = 0.4});
    const double chest = measure_body(body).chest;
    auto size = [](const Garment& shirt, int panel) {
        Eigen::RowVector2d low = Eigen::RowVector2d::Constant(1e9), high = -low;
        for (int f = 0; f < shirt.mesh.triangle_count(); ++f) {
            if (shirt.triangle_panel[f] != panel) continue;
            for (int k = 0; k < 3; ++k) {
                low = low.cwiseMin(shirt.mesh.pattern_position.row(shirt.mesh.pattern_triangle(f, k)));
                high = high.cwiseMax(shirt.mesh.pattern_position.row(shirt.mesh.pattern_triangle(f, k)));
            }
        }
        return Eigen::RowVector2d(high - low);
    };
    EXPECT_NEAR(size(wide, 0).x(), 0.5 * 1.4 * chest, 0.02);
    EXPECT_GT(size(plain, 0).x(), 0.5 * 1.12 * chest - 0.001);
    EXPECT_GT(size(long_one, 0).y(), size(plain, 0).y() + 0.1);
    EXPECT_NEAR(size(long_one, 2).y(), 0.4, 1e-9);
    expect_wearable(wide, body);
    expect_wearable(long_one, body);
}

TEST(Tshirt, number_of_vertices_follows_the_edge_length) {
    TOILE_SKIP_IN_SLOW_BUILD();
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    for (double edge : {0.045, 0.03}) {
        const Garment shirt = make_tshirt(body, {.edge_length = edge});
        EXPECT_NEAR(shirt.mesh.vertex_count() * edge * edge, 0.92, 0.1) << edge;
        EXPECT_NEAR(pattern_edge_lengths(shirt.mesh).mean(), edge, 0.1 * edge);
    }
}

TEST(Tshirt, fits_real_bodies) {
    TOILE_SKIP_IN_SLOW_BUILD();
    const std::filesystem::path folder = std::filesystem::path(TOILE_SHARED_DATA) / "bodies";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data at " << folder;
    for (const char* file : {"mh_female_cmu.glb", "mh_male_default.glb"}) {
        const skin::Body body = skin::read_rigged_body(folder / file).body;
        expect_wearable(make_tshirt(body, {.edge_length = 0.04}), body);
    }
}

TEST(Tshirt, missing_roles_are_named) {
    skin::Body body = skin::make_builtin_body({.voxel = 0.03});
    body.role[Role::left_lower_arm] = -1;
    body.role[Role::neck] = -1;
    try {
        make_tshirt(body, {});
        FAIL() << "was accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("no joint for neck, left_lower_arm"));
    }
}

TEST(Tshirt, sides_changed_over_are_refused) {
    skin::Body body = skin::make_builtin_body({.voxel = 0.03});
    std::swap(body.role[Role::left_upper_arm], body.role[Role::right_upper_arm]);
    std::swap(body.role[Role::left_lower_arm], body.role[Role::right_lower_arm]);
    EXPECT_THROW(make_tshirt(body, {}), Error);
}

TEST(Tshirt, options_out_of_range_are_refused) {
    const skin::Body none;
    for (const TshirtOptions& options :
         {TshirtOptions{.edge_length = 0.001}, TshirtOptions{.edge_length = std::numeric_limits<double>::quiet_NaN()},
          TshirtOptions{.ease = -0.5}, TshirtOptions{.body_length = 5.0}, TshirtOptions{.sleeve_length = -1.0}}) {
        try {
            make_tshirt(none, options);
            FAIL() << "was accepted";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("allowed are"));
        }
    }
}

}  // namespace
}  // namespace toile::pattern

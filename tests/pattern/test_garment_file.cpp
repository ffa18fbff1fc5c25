#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/garment_file.h"
#include "pattern/settle.h"
#include "skin/surface_query.h"
#include "tests/pattern/tube_garment.h"

namespace toile::pattern {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

Garment load(const files::MeshData& mesh, const GarmentFileOptions& options = {}, const skin::Body* body = nullptr) {
    return garment_from_mesh(mesh, options, body, "tube.obj");
}

std::string refusal(const files::MeshData& mesh, const GarmentFileOptions& options = {},
                    const skin::Body* body = nullptr) {
    try {
        load(mesh, options, body);
    } catch (const Error& error) {
        EXPECT_EQ(error.where(), "tube.obj");
        return error.what();
    }
    return {};
}

/// How the edges in space compare with the pattern's: smallest and largest ratio.
std::pair<double, double> stretch(const ClothMesh& mesh) {
    const Edges edge = build_topology(mesh.triangle).edge;
    const Eigen::VectorXd rest = pattern_edge_lengths(mesh);
    std::pair<double, double> range = {std::numeric_limits<double>::infinity(), 0.0};
    for (int e = 0; e < edge.rows(); ++e) {
        const double ratio = (mesh.rest_position.row(edge(e, 0)) - mesh.rest_position.row(edge(e, 1))).norm() / rest[e];
        range = {std::min(range.first, ratio), std::max(range.second, ratio)};
    }
    return range;
}

void expect_counter_clockwise(const ClothMesh& mesh) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto p = mesh.pattern_triangle.row(f);
        const Eigen::RowVector2d u = mesh.pattern_position.row(p[1]) - mesh.pattern_position.row(p[0]);
        const Eigen::RowVector2d v = mesh.pattern_position.row(p[2]) - mesh.pattern_position.row(p[0]);
        EXPECT_GT(u.x() * v.y() - u.y() * v.x(), 0.0) << f;
    }
}

void expect_outwards(const ClothMesh& mesh) {
    const Positions normal = vertex_normals(mesh.triangle, mesh.rest_position);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        Eigen::RowVector3d out = mesh.rest_position.row(v);
        out.y() = 0.0;
        EXPECT_GT(normal.row(v).dot(out), 0.0) << v;
    }
}

TEST(GarmentFile, sound_garment_is_sewn_and_scaled) {
    const Garment garment = load(tube_garment());
    EXPECT_EQ(garment.mesh.vertex_count(), 24 * 9);
    EXPECT_EQ(garment.mesh.pattern_position.rows(), 2 * 13 * 9);
    EXPECT_EQ(boundary_loops(garment.mesh.triangle).size(), 2u);
    EXPECT_THAT(garment.panel_name, ElementsAre("front", "back"));
    EXPECT_EQ(std::count(garment.triangle_panel.begin(), garment.triangle_panel.end(), 1), 192);
    const auto [low, high] = stretch(garment.mesh);  // a chord is a little shorter than its arc
    EXPECT_NEAR(low, 1.0, 0.01);
    EXPECT_NEAR(high, 1.0, 0.01);
    expect_counter_clockwise(garment.mesh);
    expect_outwards(garment.mesh);
    EXPECT_THAT(garment.remarks, Contains(HasSubstr("pattern scale estimated")));
    EXPECT_THAT(garment.remarks, Contains(HasSubstr("18 vertices repeated along seams were welded")));
}

TEST(GarmentFile, metric_texture_is_kept) {
    const Garment garment = load(tube_garment(0.2, 0.4, 1.02));
    const double width = garment.mesh.pattern_position.col(1).maxCoeff();
    EXPECT_NEAR(width, 0.4 / 1.02, 1e-9);
    EXPECT_THAT(garment.remarks, Contains(HasSubstr("taken as metres")));
}

TEST(GarmentFile, given_scale_is_used) {
    GarmentFileOptions options;
    options.pattern_scale = 3.0;
    EXPECT_NEAR(load(tube_garment(), options).mesh.pattern_position.col(1).maxCoeff(), 0.6, 1e-9);
}

TEST(GarmentFile, unit_and_up_axis) {
    files::MeshData mesh = tube_garment();
    const Garment upright = load(mesh);
    for (const UpAxis up : {UpAxis::z, UpAxis::x}) {
        files::MeshData turned = mesh;
        for (int v = 0; v < mesh.position.rows(); ++v) {
            const Eigen::RowVector3d p = 100.0 * mesh.position.row(v);
            if (up == UpAxis::z)
                turned.position.row(v) << p.x(), -p.z(), p.y();
            else
                turned.position.row(v) << p.y(), -p.x(), p.z();
        }
        GarmentFileOptions options;
        options.up = up;
        options.unit_scale = 0.01;
        EXPECT_LT((load(turned, options).mesh.rest_position - upright.mesh.rest_position).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(GarmentFile, positions_that_nearly_agree_are_welded) {
    files::MeshData mesh = tube_garment();
    mesh.position.array() += 0.0;
    for (int v = 0; v < mesh.position.rows(); v += 2) mesh.position(v, 1) += 1e-6;
    EXPECT_EQ(load(mesh).mesh.vertex_count(), 24 * 9);
}

TEST(GarmentFile, winding_is_mended) {
    const Garment sound = load(tube_garment());
    files::MeshData mesh = tube_garment();
    for (int f = 0; f < mesh.triangle.rows(); f += 3) std::swap(mesh.triangle(f, 0), mesh.triangle(f, 1));
    const Garment mended = load(mesh);
    expect_outwards(mended.mesh);
    expect_counter_clockwise(mended.mesh);
    EXPECT_THAT(mended.remarks, Contains(HasSubstr("128 of 384 triangles were turned over")));
    EXPECT_THAT(mended.remarks, testing::Not(Contains(HasSubstr("mirrored"))));
    EXPECT_NEAR(stretch(mended.mesh).second, stretch(sound.mesh).second, 1e-12);
}

TEST(GarmentFile, garment_inside_out_is_turned) {
    files::MeshData mesh = tube_garment();
    mesh.triangle.col(0).swap(mesh.triangle.col(1));
    expect_outwards(load(mesh).mesh);
    const skin::Body body = column_body(0.15, -0.2, 0.6);
    expect_outwards(load(mesh, {}, &body).mesh);
}

TEST(GarmentFile, mirrored_island_gets_its_u_axis_turned) {
    files::MeshData mesh = tube_garment();
    for (int v = 0; v < mesh.texture.rows() / 2; ++v) mesh.texture(v, 0) *= -1.0;
    const Garment garment = load(mesh);
    expect_counter_clockwise(garment.mesh);
    EXPECT_THAT(garment.remarks, Contains(HasSubstr("1 of 2 texture islands are mirrored")));
    EXPECT_NEAR(stretch(garment.mesh).second, 1.0, 0.01);
}

TEST(GarmentFile, island_folded_over_itself_is_divided) {
    files::MeshData mesh = tube_garment();
    const double fold = mesh.texture(6, 0);  // the middle of the front
    for (int v = 0; v < mesh.texture.rows() / 2; ++v)
        mesh.texture(v, 0) = std::min(mesh.texture(v, 0), 2 * fold - mesh.texture(v, 0));
    const Garment garment = load(mesh);
    EXPECT_EQ(garment.panel_name.size(), 3u);
    expect_counter_clockwise(garment.mesh);
}

TEST(GarmentFile, panels_lie_apart) {
    files::MeshData mesh = tube_garment();
    for (int v = 0; v < mesh.texture.rows() / 2; ++v)
        mesh.texture.row(mesh.texture.rows() / 2 + v) = mesh.texture.row(v);  // both islands in one place
    const Garment garment = load(mesh);
    double first_end = 0.0, second_start = 1e9;
    for (int f = 0; f < garment.mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const double u = garment.mesh.pattern_position(garment.mesh.pattern_triangle(f, k), 0);
            if (garment.triangle_panel[f] == 0) first_end = std::max(first_end, u);
            if (garment.triangle_panel[f] == 1) second_start = std::min(second_start, u);
        }
    }
    EXPECT_GT(second_start, first_end + 0.01);
}

TEST(GarmentFile, small_penetration_is_pushed_out) {
    const skin::Body body = column_body(0.19, -0.2, 0.6);
    files::MeshData mesh = tube_garment();
    for (int v = 0; v < mesh.position.rows(); ++v)  // a dent of up to 25 mm in front
        mesh.position(v, 2) -= mesh.position(v, 2) > 0.1 ? 0.025 : 0.0;
    GarmentFileOptions options;
    options.clearance = 0.005;
    const Garment garment = load(mesh, options, &body);
    const skin::SurfaceQuery query(body.triangle, body.rest_position);
    for (int v = 0; v < garment.mesh.vertex_count(); ++v)
        EXPECT_GT(query.nearest(garment.mesh.rest_position.row(v)).signed_distance, 0.0048) << v;
    EXPECT_THAT(garment.remarks, Contains(HasSubstr("vertices were inside the body")));
    expect_outwards(garment.mesh);
}

TEST(GarmentFile, deep_penetration_is_refused) {
    const skin::Body body = column_body(0.27, -0.2, 0.6);
    EXPECT_THAT(refusal(tube_garment(), {}, &body), HasSubstr("does not fit the body"));
}

TEST(GarmentFile, coarse_garment_is_refined) {
    GarmentFileOptions options;
    options.edge_length = 0.03;
    const Garment garment = load(tube_garment(), options);
    EXPECT_NO_THROW(check_cloth_mesh(garment.mesh, ""));
    EXPECT_LE(pattern_edge_lengths(garment.mesh).maxCoeff(), 0.03);
    EXPECT_EQ(boundary_loops(garment.mesh.triangle).size(), 2u);
    EXPECT_EQ(garment.triangle_panel.size(), static_cast<size_t>(garment.mesh.triangle_count()));
}

// One defect at a time.

TEST(GarmentFile, no_triangles) {
    files::MeshData mesh = tube_garment();
    mesh.triangle.resize(0, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("no triangles"));
}

TEST(GarmentFile, position_that_is_not_a_number) {
    files::MeshData mesh = tube_garment();
    mesh.position(7, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(mesh), HasSubstr("vertex 7 is not finite"));
}

TEST(GarmentFile, isolated_vertex) {
    files::MeshData mesh = tube_garment();
    mesh.position.conservativeResize(mesh.position.rows() + 1, 3);
    mesh.position.bottomRows(1) << 1, 1, 1;
    mesh.texture.conservativeResize(mesh.position.rows(), 2);
    mesh.texture.bottomRows(1).setZero();
    EXPECT_THAT(refusal(mesh), HasSubstr("vertex 234 belongs to no triangle"));
}

TEST(GarmentFile, index_out_of_range) {
    files::MeshData mesh = tube_garment();
    mesh.triangle(5, 1) = 5000;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 5 refers to vertex 5000"));
}

TEST(GarmentFile, edge_of_three_triangles) {
    files::MeshData mesh = tube_garment();
    mesh.position.conservativeResize(mesh.position.rows() + 1, 3);
    mesh.position.bottomRows(1) << 0, 0.2, 0.5;
    mesh.texture.conservativeResize(mesh.position.rows(), 2);
    mesh.texture.bottomRows(1) << 3, 3;
    mesh.triangle.conservativeResize(mesh.triangle.rows() + 1, 3);
    mesh.triangle.bottomRows(1) << 20, 21, 234;
    mesh.part.push_back(0);
    EXPECT_THAT(refusal(mesh), HasSubstr("belongs to more than two triangles"));
}

TEST(GarmentFile, triangle_without_area_in_space) {
    files::MeshData mesh = tube_garment();
    mesh.position.row(20) = 0.5 * (mesh.position.row(19) + mesh.position.row(21));
    mesh.position.row(33) = 0.25 * mesh.position.row(19) + 0.75 * mesh.position.row(21);
    EXPECT_THAT(refusal(mesh), HasSubstr("has no area"));
}

TEST(GarmentFile, corners_in_one_place) {
    files::MeshData mesh = tube_garment();
    mesh.position.row(20) = mesh.position.row(21);
    EXPECT_THAT(refusal(mesh), HasSubstr("two of its corners are in one place"));
}

TEST(GarmentFile, no_texture_coordinates) {
    files::MeshData mesh = tube_garment();
    mesh.texture.resize(0, 2);
    EXPECT_THAT(refusal(mesh), HasSubstr("no texture coordinates"));
}

TEST(GarmentFile, texture_all_on_a_line) {
    files::MeshData mesh = tube_garment();
    mesh.texture.col(1) = 0.5 * mesh.texture.col(0);
    EXPECT_THAT(refusal(mesh),
                HasSubstr("triangle 0 has no area in its texture coordinates (384 triangles have none)"));
}

TEST(GarmentFile, texture_all_in_one_point) {
    files::MeshData mesh = tube_garment();
    mesh.texture.setZero();
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 0 has no area in its texture coordinates"));
}

TEST(GarmentFile, one_texture_triangle_without_area) {
    files::MeshData mesh = tube_garment();
    mesh.texture.row(0) = 0.5 * (mesh.texture.row(1) + mesh.texture.row(13));
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 0 has no area in its texture coordinates"));
}

TEST(GarmentFile, texture_that_is_not_finite) {
    files::MeshData mesh = tube_garment();
    mesh.texture(3, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(mesh), HasSubstr("texture coordinates of vertex 3 are not finite"));
}

TEST(GarmentFile, moebius_band) {
    files::MeshData mesh = tube_garment();
    // Only the ring of quads j = 0, closed with a half turn: the back's last column meets the front's first upside
    // down.
    const int last = (9 + 0) * 13 + 12, above = (9 + 1) * 13 + 12;
    mesh.position.row(last) = mesh.position.row(13);
    mesh.position.row(above) = mesh.position.row(0);
    files::MeshData ring = mesh;
    std::vector<int> rows;
    for (int f = 0; f < 24; ++f) rows.push_back(f);
    for (int f = 192; f < 216; ++f) rows.push_back(f);
    ring.triangle.resize(48, 3);
    std::vector<int> number(static_cast<size_t>(mesh.position.rows()), -1);
    int count = 0;
    for (int f = 0; f < 48; ++f) {
        for (int k = 0; k < 3; ++k) {
            int& at = number[mesh.triangle(rows[f], k)];
            if (at < 0) {
                at = count++;
                ring.position.row(at) = mesh.position.row(mesh.triangle(rows[f], k));
                ring.texture.row(at) = mesh.texture.row(mesh.triangle(rows[f], k));
            }
            ring.triangle(f, k) = at;
        }
    }
    ring.position.conservativeResize(count, 3);
    ring.texture.conservativeResize(count, 2);
    EXPECT_THAT(refusal(ring), HasSubstr("cannot be wound the same way round"));
}

TEST(GarmentFile, options_out_of_range) {
    for (auto spoil :
         {+[](GarmentFileOptions& o) { o.unit_scale = 0.0; }, +[](GarmentFileOptions& o) { o.pattern_scale = -1.0; },
          +[](GarmentFileOptions& o) { o.edge_length = 1e-5; }, +[](GarmentFileOptions& o) { o.clearance = 0.5; },
          +[](GarmentFileOptions& o) { o.max_push = std::numeric_limits<double>::quiet_NaN(); }}) {
        GarmentFileOptions options;
        spoil(options);
        EXPECT_THAT(refusal(tube_garment(), options), HasSubstr("allowed are"));
    }
}

TEST(GarmentFile, real_garments_are_sewn_as_their_origin_says) {
    const std::filesystem::path folder = std::filesystem::path(TOILE_SHARED_DATA) / "garments";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data at " << folder;
    struct Expected {
        const char* file;
        int vertices, triangles;
        size_t panels, loops;
    };
    for (const Expected& expected : {Expected{"tshirt_female.obj", 1311, 2524, 4, 4},
                                     {"skirt_female.obj", 395, 728, 1, 2},
                                     {"tshirt_male.obj", 810, 1528, 4, 4},
                                     {"patterns/gpg_tee_sewn.obj", 2990, 5850, 6, 4},
                                     {"patterns/gpg_skirt_2_panels_sewn.obj", 3550, 6956, 2, 2}}) {
        const Garment garment = read_garment(folder / expected.file, {}, nullptr);
        EXPECT_EQ(garment.mesh.vertex_count(), expected.vertices) << expected.file;
        EXPECT_EQ(garment.mesh.triangle_count(), expected.triangles) << expected.file;
        EXPECT_EQ(garment.panel_name.size(), expected.panels) << expected.file;
        EXPECT_EQ(boundary_loops(garment.mesh.triangle).size(), expected.loops) << expected.file;
        EXPECT_NO_THROW(check_cloth_mesh(garment.mesh, expected.file));
        expect_counter_clockwise(garment.mesh);
    }
}

}  // namespace
}  // namespace toile::pattern

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <set>

#include "cloth/error.h"
#include "evaluate/vertex_strain.h"
#include "tests/evaluate/strain_meshes.h"

namespace toile::evaluate {
namespace {

using test::mapped;
using test::sheet;
using test::turn;
constexpr double tight = 1e-12;

std::vector<VertexStrain> fitted(const ClothMesh& mesh, const Positions& position, const std::string& rule,
                                 double normal_weight = 1, int jobs = 1) {
    const StrainRest rest = strain_rest(mesh, "");
    const Neighbourhoods around = find_neighbourhoods(rest, neighbourhood_rule(rule), jobs);
    return VertexStrainFit(rest, around, normal_weight, jobs).fit(position, jobs);
}

const char* const rules[] = {"ring:1", "ring:3", "radius:0.4", "nearest:9"};

TEST(VertexStrain, SeesNoStrainInRigidMotion) {
    const ClothMesh mesh = sheet(5, 0.8);
    for (const char* rule : rules) {
        for (const VertexStrain& one : fitted(mesh, mapped(mesh.rest_position, turn(), {4, -1, 2}), rule)) {
            EXPECT_EQ(one.fault, StrainFault::none);
            EXPECT_NEAR((one.gradient - turn()).norm(), 0, tight);
            EXPECT_NEAR((one.rotation.toRotationMatrix() - turn()).norm(), 0, tight);
            EXPECT_NEAR((one.stretch - Eigen::Vector3d::Ones()).norm(), 0, tight);
            EXPECT_NEAR(one.residual, 0, tight);
        }
    }
}

TEST(VertexStrain, IsExactInFlatNeighbourhoods) {
    const ClothMesh mesh = sheet(5);
    Eigen::Matrix3d plane = Eigen::Matrix3d::Identity();
    plane.topLeftCorner<2, 2>() << 1.2, 0.3, -0.1, 0.8;
    const Eigen::Vector2d expected = Eigen::JacobiSVD<Eigen::Matrix2d>(plane.topLeftCorner<2, 2>()).singularValues();
    for (const char* rule : rules) {
        for (const VertexStrain& one : fitted(mesh, mapped(mesh.rest_position, turn() * plane), rule)) {
            EXPECT_EQ(one.fault, StrainFault::none);
            EXPECT_NEAR((one.gradient - turn() * plane).norm(), 0, tight);
            EXPECT_NEAR((one.surface_stretch - expected).norm(), 0, tight);
            EXPECT_NEAR(one.stretch.sum(), expected.sum() + 1, tight);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR((one.gradient * one.rest_direction.col(k) - one.stretch[k] * one.direction.col(k)).norm(),
                            0, tight);
            EXPECT_NEAR(one.rotation.toRotationMatrix().determinant(), 1, tight);
        }
    }
}

TEST(VertexStrain, IsExactInSpaceWithoutTheNormal) {
    const ClothMesh mesh = sheet(5, 1.0);
    Eigen::Matrix3d a;
    a << 1.2, 0.1, 0, -0.2, 0.9, 0.3, 0.1, 0, 1.1;
    for (const VertexStrain& one : fitted(mesh, mapped(mesh.rest_position, a), "ring:2", 0)) {
        EXPECT_EQ(one.fault, StrainFault::none);
        EXPECT_NEAR((one.gradient - a).norm(), 0, 1e-11);
        EXPECT_NEAR(one.residual, 0, tight);
    }
    for (const VertexStrain& one : fitted(sheet(5), sheet(5).rest_position, "ring:2", 0)) {
        EXPECT_EQ(one.fault, StrainFault::low_rank);
        EXPECT_TRUE(std::isnan(one.stretch[0]));
    }
}

TEST(VertexStrain, HandlesReflections) {
    // A bowl pushed through: no rotation takes it there, and the determinant's sign must not become one.
    const ClothMesh mesh = sheet(6, 2.0);
    const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
    int inverted = 0;
    for (const VertexStrain& one : fitted(mesh, mapped(mesh.rest_position, mirror), "ring:2", 0)) {
        EXPECT_NEAR(one.rotation.toRotationMatrix().determinant(), 1, tight);
        inverted += one.fault == StrainFault::inverted;
        EXPECT_NEAR(one.stretch[2], 1, 1e-11);
    }
    EXPECT_EQ(inverted, mesh.vertex_count());
}

TEST(VertexStrain, IsFreeOfRigidMotionAndNumbering) {
    const ClothMesh mesh = sheet(5, 0.5);
    Positions deformed = mesh.rest_position;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.02);
    for (double& value : deformed.reshaped()) value += noise(random);
    std::vector<int> order(static_cast<size_t>(mesh.vertex_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    ClothMesh other = mesh;
    Positions other_deformed = deformed;
    const Positions moved = mapped(mesh.rest_position, turn(0.4), {3, 0, -2}),
                    away = mapped(deformed, turn(), {0, 5, 1});
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        other.rest_position.row(order[v]) = moved.row(v);
        other_deformed.row(order[v]) = away.row(v);
    }
    for (int& corner : other.triangle.reshaped()) corner = order[corner];
    for (const char* rule : rules) {
        const auto plain = fitted(mesh, deformed, rule), shuffled = fitted(other, other_deformed, rule);
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            EXPECT_NEAR((plain[v].stretch - shuffled[order[v]].stretch).norm(), 0, 1e-11) << rule;
            EXPECT_NEAR(plain[v].residual, shuffled[order[v]].residual, 1e-11);
        }
    }
}

TEST(VertexStrain, AveragesNoiseOverItsNeighbourhood) {
    const ClothMesh mesh = sheet(30);
    std::mt19937 random(9);
    std::normal_distribution<double> noise(0, 1e-4);
    Positions noisy = mesh.rest_position;
    for (double& value : noisy.leftCols<2>().reshaped()) value += noise(random);
    std::vector<double> spread;
    for (const char* rule : {"ring:1", "ring:2", "ring:4"}) {
        double square = 0;
        for (const VertexStrain& one : fitted(mesh, noisy, rule))
            square += (one.surface_stretch.array() - 1).square().sum();
        spread.push_back(std::sqrt(square / (2 * mesh.vertex_count())));
    }
    EXPECT_LT(spread[1], 0.6 * spread[0]);
    EXPECT_LT(spread[2], 0.6 * spread[1]);
}

TEST(VertexStrain, NamesWhatHasNoValues) {
    ClothMesh mesh = sheet(3);
    const int lone = mesh.vertex_count();
    mesh.rest_position.conservativeResize(lone + 4, 3);
    mesh.rest_position.row(lone) << 5, 5, 5;                                        // without a triangle
    for (int k = 1; k < 4; ++k) mesh.rest_position.row(lone + k) << 3.0 * k, 0, 0;  // a triangle that is a line
    mesh.triangle.conservativeResize(mesh.triangle.rows() + 1, 3);
    mesh.triangle.bottomRows<1>() << lone + 1, lone + 2, lone + 3;
    const auto strain = fitted(mesh, mesh.rest_position, "ring:1");
    EXPECT_EQ(strain[lone].fault, StrainFault::too_few);
    EXPECT_EQ(strain[lone + 1].fault, StrainFault::no_normal);
    EXPECT_EQ(strain[0].fault, StrainFault::none);
    const auto near = fitted(mesh, mesh.rest_position, "radius:0.001");
    EXPECT_EQ(near[0].fault, StrainFault::too_few);
}

TEST(VertexStrain, ExplainsEveryMissingValueOfDamagedMeshes) {
    std::mt19937 random(19);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::uniform_int_distribution<int> pick(0, 11), size(-320, 300), kind(0, 5);
    for (int round = 0; round < 300; ++round) {
        ClothMesh mesh;
        mesh.rest_position.resize(12, 3);
        mesh.triangle.resize(20, 3);
        const double scale = kind(random) == 0 ? std::pow(10.0, size(random)) : 1;
        for (double& value : mesh.rest_position.reshaped()) value = kind(random) == 0 ? 0 : scale * unit(random);
        for (int& corner : mesh.triangle.reshaped()) corner = pick(random);
        Positions deformed(12, 3);
        const double other = kind(random) == 0 ? std::pow(10.0, size(random)) : scale;
        for (double& value : deformed.reshaped()) value = kind(random) == 0 ? 0 : other * unit(random);
        for (const VertexStrain& one : fitted(mesh, deformed, rules[round % 4], round % 3 == 0 ? 0 : 1)) {
            const bool whole = one.stretch.allFinite() && one.gradient.allFinite() && one.direction.allFinite() &&
                               one.surface_stretch.allFinite() && one.rotation.coeffs().allFinite() &&
                               std::isfinite(one.residual);
            EXPECT_EQ(whole, has_strain(one.fault)) << round << " " << strain_fault_name(one.fault);
        }
    }
}

TEST(Neighbourhood, FollowsItsRule) {
    const ClothMesh mesh = sheet(8);
    const StrainRest rest = strain_rest(mesh, "");
    const auto around = [&](const std::string& rule, int v) {
        const Neighbourhoods all = find_neighbourhoods(rest, neighbourhood_rule(rule), 2);
        EXPECT_EQ(all.point[all.offset[v]], v) << "the centre first";
        return std::set<int>(all.point.begin() + all.offset[v], all.point.begin() + all.offset[v + 1]);
    };
    const int middle = 40;
    EXPECT_EQ(around("ring:1", middle), (std::set<int>{30, 31, 39, 40, 41, 49, 50}));
    EXPECT_EQ(around("ring:20", middle).size(), 81u);
    std::set<int> within;
    std::vector<std::pair<double, int>> far;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        far.emplace_back((mesh.rest_position.row(v) - mesh.rest_position.row(middle)).norm(), v);
        if (far.back().first <= 0.3) within.insert(v);
    }
    EXPECT_EQ(around("radius:0.3", middle), within);
    std::sort(far.begin(), far.end());
    std::set<int> nearest;
    for (int k = 0; k <= 12; ++k) nearest.insert(far[k].second);
    EXPECT_EQ(around("nearest:12", middle), nearest);
}

TEST(Neighbourhood, StaysWithinTheSheetAndThePanel) {
    // Two panels, sewn along one edge: in the pattern they lie on each other.
    ClothMesh mesh;
    mesh.rest_position.resize(5, 3);
    mesh.rest_position << 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, -1, 0.5, 0;
    mesh.triangle.resize(3, 3);
    mesh.triangle << 0, 2, 1, 2, 3, 1, 0, 1, 4;
    mesh.pattern_position.resize(7, 2);
    mesh.pattern_position << 0, 0, 0, 1, 1, 0, 1, 1, 0, 0, 0, 1, -1, 0.5;
    mesh.pattern_triangle.resize(3, 3);
    mesh.pattern_triangle << 0, 2, 1, 2, 3, 1, 4, 5, 6;
    const StrainRest rest = strain_rest(mesh, "");
    const Neighbourhoods all = find_neighbourhoods(rest, neighbourhood_rule("radius:10"), 1);
    EXPECT_EQ(all.centre, (std::vector<int>{0, 1, 2, 3, 6})) << "the larger panel at the seam";
    EXPECT_EQ(all.offset[1], 4);
    EXPECT_EQ(all.offset[5] - all.offset[4], 3);
}

TEST(Neighbourhood, RefusesOtherRules) {
    for (const char* text : {"", "ring", "ring:", "ring:0", "ring:-1", "ring:1.5", "radius:0", "radius:-1",
                             "radius:nan", "radius:inf", "radius:1m", "nearest:0", "nearest:x", "cube:2"})
        EXPECT_THROW(neighbourhood_rule(text), Error) << text;
    EXPECT_EQ(neighbourhood_rule("radius:0.03").text(), "radius:0.03");
    EXPECT_EQ(neighbourhood_rule("nearest:12").text(), "nearest:12");
}

}  // namespace
}  // namespace toile::evaluate

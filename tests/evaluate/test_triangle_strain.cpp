#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "cloth/error.h"
#include "evaluate/triangle_strain.h"
#include "tests/evaluate/strain_meshes.h"

namespace toile::evaluate {
namespace {

using test::mapped;
using test::sheet;
using test::turn;
constexpr double tight = 1e-12;

void expect_stretches(const std::vector<TriangleStrain>& strain, double first, double second,
                      double tolerance = tight) {
    for (const TriangleStrain& one : strain) {
        EXPECT_EQ(one.fault, StrainFault::none);
        EXPECT_NEAR(one.stretch[0], first, tolerance);
        EXPECT_NEAR(one.stretch[1], second, tolerance);
    }
}

TEST(TriangleStrain, SeesNoStrainInRigidMotion) {
    const ClothMesh mesh = sheet(4, 0.8);
    const StrainRest rest = strain_rest(mesh, "");
    const auto strain = triangle_strain(rest, mapped(mesh.rest_position, turn(), {1, 2, 3}), 1);
    expect_stretches(strain, 1, 1);
    for (size_t f = 0; f < strain.size(); ++f)
        EXPECT_NEAR((strain[f].rotation - turn() * rest.frame[f].axis).norm(), 0, tight);
}

TEST(TriangleStrain, MeasuresPureStretchWithDirections) {
    const ClothMesh mesh = sheet(4);
    const Eigen::Matrix3d u = Eigen::Vector3d(1.25, 0.75, 1).asDiagonal();
    const auto strain = triangle_strain(strain_rest(mesh, ""), mapped(mesh.rest_position, turn() * u), 1);
    expect_stretches(strain, 1.25, 0.75);
    for (const TriangleStrain& one : strain) {
        EXPECT_NEAR((one.rest_direction.col(0) - Eigen::Vector3d::UnitX()).norm(), 0, tight);
        EXPECT_NEAR((one.rest_direction.col(1) - Eigen::Vector3d::UnitY()).norm(), 0, tight);
        EXPECT_NEAR((one.direction.col(0) - turn().col(0)).norm(), 0, tight);
        EXPECT_NEAR((one.direction.col(1) - turn().col(1)).norm(), 0, tight);
    }
}

TEST(TriangleStrain, MeasuresSimpleShear) {
    // Eigenvalues of F^T F for F = [1 g; 0 1]: 1 + g^2/2 +- g sqrt(1 + g^2/4).
    const double g = 0.7, first = std::sqrt(1 + g * g / 2 + g * std::sqrt(1 + g * g / 4));
    Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
    shear(0, 1) = g;
    const ClothMesh mesh = sheet(4);
    const auto strain = triangle_strain(strain_rest(mesh, ""), mapped(mesh.rest_position, turn() * shear), 1);
    expect_stretches(strain, first, 1 / first);
    // The polar rotation of simple shear turns by -atan(g / 2).
    const Eigen::Matrix3d rotation =
        turn() * Eigen::AngleAxisd(-std::atan(g / 2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const StrainRest rest = strain_rest(mesh, "");
    for (size_t f = 0; f < strain.size(); ++f)
        EXPECT_NEAR((strain[f].rotation - rotation * rest.frame[f].axis).norm(), 0, tight);
}

TEST(TriangleStrain, IsAPolarDecomposition) {
    const ClothMesh mesh = sheet(5, 0.5);
    Positions noisy = mesh.rest_position;
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.03);
    for (double& value : noisy.reshaped()) value += noise(random);
    for (const TriangleStrain& one : triangle_strain(strain_rest(mesh, ""), noisy, 1)) {
        const Eigen::Matrix2d u = one.rotation.transpose() * one.gradient;
        EXPECT_NEAR((one.rotation.transpose() * one.rotation - Eigen::Matrix2d::Identity()).norm(), 0, tight);
        EXPECT_NEAR((u - u.transpose()).norm(), 0, tight);
        EXPECT_NEAR((one.rotation * u - one.gradient).norm(), 0, tight);
        EXPECT_NEAR(u.trace(), one.stretch.sum(), tight);
        EXPECT_NEAR(u.determinant(), one.stretch.prod(), tight);
        EXPECT_GE(one.stretch[0], one.stretch[1]);
    }
}

TEST(TriangleStrain, IsFreeOfRigidMotionAndNumbering) {
    const ClothMesh mesh = sheet(5, 0.5);
    Positions deformed = mesh.rest_position;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.02);
    for (double& value : deformed.reshaped()) value += noise(random);
    const auto plain = triangle_strain(strain_rest(mesh, ""), deformed, 1);

    ClothMesh moved = mesh;
    moved.rest_position = mapped(mesh.rest_position, turn(0.4), {3, 0, -2});
    const auto turned = triangle_strain(strain_rest(moved, ""), mapped(deformed, turn(), {0, 5, 1}), 1);

    std::vector<int> order(static_cast<size_t>(mesh.vertex_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    ClothMesh renumbered = mesh;
    Positions renumbered_deformed = deformed;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        renumbered.rest_position.row(order[v]) = mesh.rest_position.row(v);
        renumbered_deformed.row(order[v]) = deformed.row(v);
    }
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f)  // corners take turns too
        for (int corner = 0; corner < 3; ++corner)
            renumbered.triangle(f, (corner + 1) % 3) = order[mesh.triangle(f, corner)];
    const auto shuffled = triangle_strain(strain_rest(renumbered, ""), renumbered_deformed, 1);
    for (size_t f = 0; f < plain.size(); ++f) {
        EXPECT_NEAR((plain[f].stretch - turned[f].stretch).norm(), 0, 1e-11);
        EXPECT_NEAR((plain[f].stretch - shuffled[f].stretch).norm(), 0, tight);
        EXPECT_NEAR((turn() * plain[f].direction.col(0)).cross(turned[f].direction.col(0)).norm(), 0, 1e-8);
    }
}

TEST(TriangleStrain, TakesThePatternForTheRestState) {
    ClothMesh mesh = sheet(3, 0.4);
    mesh.pattern_position = mesh.rest_position.leftCols<2>() * 0.5;
    mesh.pattern_triangle = mesh.triangle;
    Positions flat = mesh.rest_position;
    flat.col(2).setZero();
    const StrainRest rest = strain_rest(mesh, "");
    EXPECT_TRUE(rest.from_pattern);
    expect_stretches(triangle_strain(rest, mapped(flat, turn()), 1), 2, 2);
}

TEST(TriangleStrain, NamesDegenerateAndCollapsedTriangles) {
    ClothMesh mesh = sheet(3);
    const int lone = mesh.triangle(0, 1);
    mesh.rest_position.row(lone) = mesh.rest_position.row(mesh.triangle(0, 0));
    const StrainRest rest = strain_rest(mesh, "");
    const auto at_rest = triangle_strain(rest, sheet(3).rest_position, 1);
    EXPECT_EQ(at_rest[0].fault, StrainFault::degenerate_rest);
    EXPECT_TRUE(std::isnan(at_rest[0].stretch[0]));

    const ClothMesh whole = sheet(3);
    Positions line = whole.rest_position;
    line.col(1).setZero();
    for (const TriangleStrain& one : triangle_strain(strain_rest(whole, ""), mapped(line, turn()), 1)) {
        EXPECT_EQ(one.fault, StrainFault::collapsed);
        EXPECT_NEAR(one.stretch[0], 1, tight);
        EXPECT_NEAR(one.stretch[1], 0, tight);
    }
}

TEST(TriangleStrain, FindsTurnedOverTrianglesWhereAllIsFlat) {
    const ClothMesh mesh = sheet(4);
    const StrainRest rest = strain_rest(mesh, "");
    Positions folded = mesh.rest_position;
    folded.row(12) += Eigen::RowVector3d(0.45, 0.1, 0);  // the middle one, past its neighbours
    const auto strain = triangle_strain(rest, mapped(folded, turn()), 1);
    int inverted = 0;
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f) {
        const Eigen::Vector3d a = folded.row(mesh.triangle(f, 0)), b = folded.row(mesh.triangle(f, 1)),
                              c = folded.row(mesh.triangle(f, 2));
        const bool over = (b - a).cross(c - a).z() < 0;
        EXPECT_EQ(strain[f].fault, over ? StrainFault::inverted : StrainFault::none) << f;
        inverted += over;
    }
    EXPECT_GT(inverted, 0);
    folded(12, 2) = 0.1;  // no longer flat: a fold, and no fault
    for (const TriangleStrain& one : triangle_strain(rest, folded, 1)) EXPECT_EQ(one.fault, StrainFault::none);
    // A sheet turned over as a whole is not inverted.
    for (const TriangleStrain& one :
         triangle_strain(rest, mapped(mesh.rest_position, Eigen::Vector3d(-1, 1, 1).asDiagonal()), 1))
        EXPECT_EQ(one.fault, StrainFault::none);
}

TEST(TriangleStrain, SeesNoiseAsItsStatisticsSay) {
    // Right triangles of legs h, noise s in each coordinate: F = I + E, and to first order the mean of the two strains
    // is (E11 + E22) / 2 with E11 = (x1 - x0) / h, E22 = (y2 - y0) / h, independent, of variance 2 s^2 / h^2 each.
    ClothMesh mesh;
    const int count = 20000;
    const double h = 0.1, s = 1e-4;
    mesh.rest_position.resize(3 * count, 3);
    mesh.triangle.resize(count, 3);
    for (int f = 0; f < count; ++f) {
        mesh.rest_position.middleRows(3 * f, 3) << 0, 0, 0, h, 0, 0, 0, h, 0;
        mesh.triangle.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
    }
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0, s);
    Positions noisy = mesh.rest_position;
    for (double& value : noisy.reshaped()) value += noise(random);
    double mean = 0, square = 0;
    for (const TriangleStrain& one : triangle_strain(strain_rest(mesh, ""), noisy, 2)) {
        const double strain = 0.5 * one.stretch.sum() - 1;
        mean += strain / count;
        square += strain * strain / count;
    }
    const double expected = s / h;
    EXPECT_NEAR(std::sqrt(square) / expected, 1, 0.03);
    EXPECT_NEAR(mean / expected, 0, 0.05);
}

TEST(TriangleStrain, ExplainsEveryMissingValueOfDamagedMeshes) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::uniform_int_distribution<int> pick(0, 11), size(-320, 300), kind(0, 5);
    for (int round = 0; round < 400; ++round) {
        ClothMesh mesh;
        mesh.rest_position.resize(12, 3);
        mesh.triangle.resize(20, 3);
        const double scale = kind(random) == 0 ? std::pow(10.0, size(random)) : 1;
        for (double& value : mesh.rest_position.reshaped()) value = kind(random) == 0 ? 0 : scale * unit(random);
        for (int& corner : mesh.triangle.reshaped()) corner = pick(random);
        Positions deformed(12, 3);
        const double other = kind(random) == 0 ? std::pow(10.0, size(random)) : scale;
        for (double& value : deformed.reshaped()) value = kind(random) == 0 ? 0 : other * unit(random);
        for (const TriangleStrain& one : triangle_strain(strain_rest(mesh, ""), deformed, 1)) {
            const bool whole = one.stretch.allFinite() && one.gradient.allFinite() && one.direction.allFinite() &&
                               one.rest_direction.allFinite() && one.rotation.allFinite();
            EXPECT_EQ(whole, has_strain(one.fault)) << round << " " << strain_fault_name(one.fault);
            EXPECT_TRUE(!whole || one.stretch[1] >= 0);
        }
    }
}

TEST(TriangleStrain, DoesNotDependOnTheThreads) {
    const ClothMesh mesh = sheet(20, 0.5);
    const Positions deformed = mapped(mesh.rest_position, Eigen::Matrix3d(turn() * 1.1));
    const auto one = triangle_strain(strain_rest(mesh, ""), deformed, 1);
    const auto three = triangle_strain(strain_rest(mesh, ""), deformed, 3);
    for (size_t f = 0; f < one.size(); ++f) EXPECT_EQ(one[f].gradient, three[f].gradient);
}

TEST(StrainRest, RefusesWhatIsNoMesh) {
    ClothMesh mesh = sheet(2);
    mesh.rest_position(3, 1) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(strain_rest(mesh, "a.obj"), Error);
    mesh = sheet(2);
    mesh.triangle(1, 1) = 99;
    EXPECT_THROW(strain_rest(mesh, "a.obj"), Error);
    mesh = sheet(2);
    mesh.triangle.resize(0, 3);
    EXPECT_THROW(strain_rest(mesh, "a.obj"), Error);
}

}  // namespace
}  // namespace toile::evaluate

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "evaluate/case_meshes.h"
#include "evaluate/cloth_quantities.h"
#include "skin/surface_extraction.h"

namespace toile::evaluate {
namespace {

constexpr double radian = std::numbers::pi / 180;

ClothMesh sheet() {
    return grid_cloth(even_lines(6, 0.3), even_lines(5, 0.25), 0.0, 0.2);
}

Positions turned(const Positions& x, double degrees) {
    return x * Eigen::AngleAxisd(degrees * radian, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
}

class Quantities : public ::testing::Test {
  protected:
    QuantityValues judge(const Positions& cloth) const { return judge_.judge(cloth, target_); }
    double value(const Positions& cloth, Quantity quantity) const { return at(judge(cloth), quantity); }

    ClothMesh mesh_ = sheet();
    Positions rest_ = mesh_.rest_position;
    ClothJudge judge_{mesh_, 0.05};
    JudgedTarget target_ = judge_.target(rest_);
};

TEST_F(Quantities, OfTheTargetItselfAreZero) {
    const QuantityValues same = judge(rest_);
    for (const Quantity one : {Quantity::sqrt_mse, Quantity::max_dist, Quantity::stretching_energy_error,
                               Quantity::compression_energy_error, Quantity::normal_error})
        EXPECT_EQ(at(same, one), 0.0) << quantity_kind(one).name;
    EXPECT_NEAR(at(same, Quantity::largest_stretch), 1.0, 1e-12);
    EXPECT_TRUE(std::isnan(at(same, Quantity::penetration))) << "without a body nothing is said of it";
}

TEST_F(Quantities, OfAShiftedSheetAreItsDistance) {
    Positions shifted = rest_.rowwise() + Eigen::RowVector3d(0.003, 0.0, 0.004);
    EXPECT_NEAR(value(shifted, Quantity::sqrt_mse), 5.0, 1e-9);
    EXPECT_NEAR(value(shifted, Quantity::max_dist), 5.0, 1e-9);
    EXPECT_NEAR(value(shifted, Quantity::normal_error), 0.0, 1e-6);
    EXPECT_NEAR(value(shifted, Quantity::stretching_energy_error), 0.0, 1e-20);
    shifted.row(3) += Eigen::RowVector3d(0, 0.02, 0);
    EXPECT_NEAR(value(shifted, Quantity::max_dist), 1e3 * std::sqrt(25e-6 + 400e-6), 1e-9);
}

TEST_F(Quantities, OfAScaledSheetAreThoseOfItsEdges) {
    const auto model = prior::QuasistaticModel::from(prior::rest_state(mesh_));
    const double tenth = (0.5 * model.edge_stiffness.array() * (0.1 * model.edge_rest_length.array()).square()).sum();
    const QuantityValues larger = judge(1.1 * rest_), smaller = judge(0.9 * rest_);
    EXPECT_NEAR(at(larger, Quantity::stretching_energy), tenth, 1e-12);
    EXPECT_NEAR(at(larger, Quantity::compression_energy), 0.0, 1e-20);
    EXPECT_NEAR(at(smaller, Quantity::compression_energy), tenth, 1e-12);
    EXPECT_NEAR(at(smaller, Quantity::stretching_energy), 0.0, 1e-20);
    EXPECT_NEAR(at(larger, Quantity::stretching_energy_error), tenth, 1e-12);
    EXPECT_NEAR(at(larger, Quantity::largest_stretch), 1.1, 1e-12);
    EXPECT_EQ(at(larger, Quantity::overstretched_share), 100.0);
    EXPECT_EQ(at(smaller, Quantity::overstretched_share), 0.0);
    EXPECT_EQ(at(ClothJudge(mesh_, 0.1).judge(1.1 * rest_, target_), Quantity::overstretched_share), 0.0)
        << "at the limit is not beyond it";
}

TEST_F(Quantities, TellAnEnergyErrorWithoutItsSign) {
    const JudgedTarget stretched = judge_.target(1.1 * rest_);
    EXPECT_GT(at(judge_.judge(rest_, stretched), Quantity::stretching_energy_error), 0.0);
}

TEST_F(Quantities, KnowTheAngleOfNormals) {
    for (const double degrees : {0.01, 30.0, 90.0, 179.0}) {
        const Positions other =
            rest_ * Eigen::AngleAxisd(degrees * radian, Eigen::Vector3d::UnitX()).toRotationMatrix();
        EXPECT_NEAR(value(other, Quantity::normal_error), degrees, 1e-6);
    }
    Positions mirrored = rest_;
    mirrored.col(0) *= -1;
    EXPECT_NEAR(value(mirrored, Quantity::normal_error), 180.0, 1e-6);
}

TEST_F(Quantities, CountDegenerateNormalsOut) {
    Positions cloth = rest_ * Eigen::AngleAxisd(30 * radian, Eigen::Vector3d::UnitX()).toRotationMatrix();
    // All that surrounds the first corner falls onto it.
    for (int f = 0; f < mesh_.triangle_count(); ++f)
        if ((mesh_.triangle.row(f).array() == 0).any())
            for (int k = 0; k < 3; ++k) cloth.row(mesh_.triangle(f, k)) = cloth.row(0);
    ASSERT_TRUE(area_weighted_normals(mesh_.triangle, cloth).row(0).isZero(0.0));
    EXPECT_NEAR(value(cloth, Quantity::normal_error), 30.0, 1e-6) << "the others still lie in their plane";
    EXPECT_TRUE(std::isnan(value(Positions::Zero(rest_.rows(), 3), Quantity::normal_error)));
}

TEST_F(Quantities, AreNoneOfAClothThatIsNotFinite) {
    Positions cloth = rest_;
    cloth(4, 1) = std::numeric_limits<double>::infinity();
    for (const double one : judge(cloth)) EXPECT_TRUE(std::isnan(one));
}

TEST_F(Quantities, DrawStretchAndStrainOnTheCloth) {
    Positions cloth = rest_;
    cloth.col(0) *= 1.2;
    const ClothFields fields = judge_.fields(turned(cloth, 40), turned(rest_, 40));
    EXPECT_LT((fields.strain.array() - 0.2).abs().maxCoeff(), 1e-12);
    EXPECT_LT((fields.stretch.array() - 1.2).abs().maxCoeff(), 1e-12) << "each vertex has an edge along x";
    EXPECT_LT((fields.distance - (cloth - rest_).rowwise().norm()).cwiseAbs().maxCoeff(), 1e-12);
    const ClothFields smaller = judge_.fields(0.75 * rest_, rest_);
    EXPECT_LT((smaller.stretch.array() - 0.75).abs().maxCoeff(), 1e-12);
    EXPECT_LT((smaller.strain.array() + 0.25).abs().maxCoeff(), 1e-12);
}

TEST_F(Quantities, NeedNoPattern) {
    ClothMesh bare = mesh_;
    bare.pattern_position.resize(0, 2);
    bare.pattern_triangle.resize(0, 3);
    bare.rest_position = turned(rest_, 77);
    const ClothJudge judge(bare, 0.05);
    EXPECT_LT((judge.fields(1.1 * rest_, rest_).strain.array() - 0.1).abs().maxCoeff(), 1e-12);
    EXPECT_NEAR(at(judge.judge(1.1 * rest_, judge.target(rest_)), Quantity::largest_stretch), 1.1, 1e-12);
}

TEST(Penetration, IsThatOfTheDeepestVertex) {
    const auto sphere = [](const Eigen::Vector3d& p) { return p.norm() - 0.2; };
    const skin::Surface surface =
        skin::extract_surface(sphere, Eigen::Vector3d::Constant(-0.25), Eigen::Vector3d::Constant(0.25), 0.01);
    const auto body = std::make_shared<const skin::SurfaceQuery>(surface.triangle, surface.position);
    const ClothMesh mesh = sheet();
    const ClothJudge judge(mesh, 0.05);
    const auto at_height = [&](double y) -> Positions {
        return mesh.rest_position.rowwise() + Eigen::RowVector3d(0, y, 0);
    };
    double deepest = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v)
        deepest = std::max(deepest, 0.2 - (mesh.rest_position.row(v) + Eigen::RowVector3d(0, 0.15, 0)).norm());
    ASSERT_GT(deepest, 0.02);
    for (const double known : {0.21, 0.3, 0.15}) {  // the nearer the target, the fewer vertices need a query
        const JudgedTarget target = judge.target(at_height(known), body);
        EXPECT_NEAR(at(judge.judge(at_height(0.15), target), Quantity::penetration), 1e3 * deepest, 0.5);
        EXPECT_EQ(at(judge.judge(at_height(0.22), target), Quantity::penetration), 0.0);
    }
}

}  // namespace
}  // namespace toile::evaluate

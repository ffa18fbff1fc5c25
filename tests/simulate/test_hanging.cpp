#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "simulate/drape.h"
#include "tests/simulate/cloth_square.h"

/// Cloth at rest against shapes that have a formula.
namespace toile::simulate {
namespace {

/// A vertical strip of `cells` x `cells` cells in the plane z = 0, pinned along its top (v = side).
DrapeScene hung_patch(int cells, double side) {
    DrapeScene scene;
    scene.mesh = test::cloth_square(cells, side, 0.0, 1.0);
    for (int v = 0; v < scene.mesh.vertex_count(); ++v)
        scene.mesh.rest_position.row(v) << scene.mesh.pattern_position.row(v), 0.0;
    for (int i = 0; i <= cells; ++i) scene.pinned.push_back(cells * (cells + 1) + i);
    scene.membrane.density_per_area = 1.0;
    scene.solver.residual_tolerance = 1e-8;
    return scene;
}

/// Length of a strip of unit width, rest length L, weight w per area, hung by one end, with St. Venant-Kirchhoff's law
/// between tension and stretch λ: T = E (λ² − 1) λ / 2, T(s) = w s. By Simpson's rule over the rest length.
double hung_length(double modulus, double weight, double length) {
    const auto stretch = [&](double s) {
        double lambda = 1.0;
        for (int k = 0; k < 50; ++k)
            lambda -= (0.5 * modulus * (lambda * lambda - 1.0) * lambda - weight * s) /
                      (0.5 * modulus * (3.0 * lambda * lambda - 1.0));
        return lambda;
    };
    double sum = 0.0;
    for (int k = 0; k <= 200; ++k) sum += (k == 0 || k == 200 ? 1 : k % 2 ? 4 : 2) * stretch(length * k / 200.0);
    return sum * length / 600.0;
}

/// Relative error of how far a patch of `cells` x `cells` lengthens under its own weight.
double stretch_error(const std::string& solver, int cells, double modulus) {
    // Without coupling of the axes nothing happens along weft, and every column of the patch is a strip.
    DrapeScene scene = hung_patch(cells, 0.5);
    scene.membrane.warp_stiffness = modulus;
    scene.membrane.weft_stiffness = 300.0;
    scene.membrane.poisson_ratio = 0.0;
    scene.solver.solver = solver;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_LE(result.certificate.residual_force, 1e-8) << solver << ", " << cells << " cells";
    const double expected = hung_length(modulus, 9.81, 0.5) - 0.5;
    EXPECT_NEAR(result.position.row(0).x(), 0.0, 0.08 / cells * expected) << "nothing happens along weft";
    return std::abs(-result.position.topRows(cells + 1).col(1).mean() / expected - 1.0);
}

TEST(Hanging, APatchStretchesByItsWeight) {
    for (const double modulus : {20.0, 200.0, 2000.0}) {
        // Constant stretch in each row of triangles: the error falls with the square of their number.
        double before = stretch_error("implicit", 4, modulus);
        EXPECT_LT(before, 0.05) << modulus;
        for (const int cells : {8, 16}) {
            const double error = stretch_error("implicit", cells, modulus);
            EXPECT_LT(error, 0.3 * before) << modulus << " N/m, " << cells << " cells";
            before = error;
        }
    }
}

TEST(Hanging, APatchStretchesTheSameWithXpbd) {
    EXPECT_NEAR(stretch_error("xpbd", 8, 200.0), stretch_error("implicit", 8, 200.0), 1e-5);
}

TEST(Hanging, AStrainLimitHoldsToOnePercent) {
    for (const double modulus : {2.0, 20.0}) {
        DrapeScene scene = hung_patch(16, 0.5);
        scene.membrane.warp_stiffness = modulus;
        scene.membrane.poisson_ratio = 0.0;
        scene.strain_limit = StrainLimitOptions{1.1, 1.05};
        const DrapeResult result = Draper(scene).drape_neutral();
        ASSERT_LE(result.certificate.residual_force, 1e-8);
        double longest = 0.0;
        for (int f = 0; f < scene.mesh.triangle_count(); ++f) {
            TrianglePositions x;
            for (int i = 0; i < 3; ++i) x.col(i) = result.position.row(scene.mesh.triangle(f, i)).transpose();
            const Eigen::Matrix<double, 3, 2> gradient = x * membrane_stencil(scene.mesh, f).corner_gradient;
            longest = std::max(longest, gradient.col(1).norm());
        }
        EXPECT_GT(longest, 1.1);
        EXPECT_LT(longest, 1.1 * 1.01);
    }
}

/// A strip along x of rest length `length`, one cell wide, its ends `span` apart at the same height.
DrapeScene hung_strip(int cells, double length, double span) {
    const double width = length / cells;
    DrapeScene scene;
    ClothMesh& mesh = scene.mesh;
    mesh.pattern_position.resize(2 * (cells + 1), 2);
    mesh.rest_position.resize(2 * (cells + 1), 3);
    mesh.triangle.resize(2 * cells, 3);
    for (int i = 0; i <= cells; ++i) {
        const double s = length * i / cells, sag = 0.3 * length * std::sin(M_PI * i / cells);
        for (int side = 0; side < 2; ++side) {
            mesh.pattern_position.row(2 * i + side) << s, side * width;
            mesh.rest_position.row(2 * i + side) << span * i / cells, -sag, -side * width;
        }
        if (i == cells) continue;
        mesh.triangle.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
        mesh.triangle.row(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
    }
    mesh.pattern_triangle = mesh.triangle;
    mesh.mass = Eigen::VectorXd::Constant(2 * (cells + 1), 0.2 * width * width);
    scene.pinned = {0, 1, 2 * cells, 2 * cells + 1};
    scene.solver.residual_tolerance = 1e-7;
    return scene;
}

/// Depth of a catenary y = a cosh(x / a) of arc length L below its ends, `span` apart: 2 a sinh(span / 2a) = L.
double catenary_depth(double length, double span) {
    double low = 1e-3 * span, high = 1e3 * span;
    for (int k = 0; k < 200; ++k) {
        const double a = 0.5 * (low + high), arc = 2.0 * a * std::sinh(0.5 * span / a);
        (arc > length ? low : high) = a;
    }
    return low * (std::cosh(0.5 * span / low) - 1.0);
}

/// Relative error of the depth of a strip of 1 m whose ends are 0.6 m apart, against the catenary.
double catenary_error(const std::string& solver, int cells, double modulus, double residual) {
    DrapeScene scene = hung_strip(cells, 1.0, 0.6);
    scene.membrane.warp_stiffness = scene.membrane.weft_stiffness = modulus;
    scene.membrane.shear_stiffness = 0.3 * modulus;
    scene.solver.solver = solver;
    scene.solver.residual_tolerance = residual;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_LE(result.certificate.residual_force, residual) << solver << ", " << cells << " cells";
    return std::abs(-result.position.row(cells).y() / catenary_depth(1.0, 0.6) - 1.0);
}

TEST(Hanging, AStiffStripIsACatenary) {
    double before = 1.0;
    for (const int cells : {16, 32, 64}) {
        const double error = catenary_error("implicit", cells, 1e5, 1e-7);
        EXPECT_LT(error, 0.35 * before) << "the error falls with the square of the cells";
        EXPECT_LT(error, 2.0 / (cells * cells)) << cells;
        before = error;
    }
}

TEST(Hanging, AStripIsTheSameCatenaryWithXpbd) {
    EXPECT_LT(catenary_error("xpbd", 16, 1e4, 1e-4), 2.0 / (16 * 16));
}

TEST(Hanging, AStripKeepsTheShapeItStartedFrom) {
    // Bending about the start: without gravity nothing moves; flat, it opens.
    DrapeScene scene = hung_strip(16, 1.0, 0.6);
    ClothMesh& mesh = scene.mesh;
    for (int i = 0; i <= 16; ++i)  // a half circle's polygon whose sides have their pattern's length
        for (int side = 0; side < 2; ++side) {
            const double angle = M_PI * i / 16.0, radius = (1.0 / 32.0) / std::sin(M_PI / 32.0);
            mesh.rest_position.row(2 * i + side).head<2>() << -radius * std::cos(angle), -radius * std::sin(angle);
        }
    scene.pinned = {0, 1, 2};
    scene.solver.gravity.setZero();
    scene.bending = BendingOptions{1e-3, BendingRest::start};
    const Positions kept = Draper(scene).drape_neutral().position;
    EXPECT_LT((kept - mesh.rest_position).cwiseAbs().maxCoeff(), 1e-6);
    scene.bending->rest = BendingRest::flat;
    scene.solver.residual_tolerance = 1e-6;
    const Positions opened = Draper(scene).drape_neutral().position;
    EXPECT_GT((opened - mesh.rest_position).rowwise().norm().maxCoeff(), 0.3);
}

TEST(Hanging, WindLeansAPatchByItsForceOverItsWeight) {
    // A flag hung by its top edge, stiff along the wind's width: light wind leans every part by about the same angle,
    // tan α = pressure / weight for the plate that it nearly is.
    DrapeScene scene = hung_patch(12, 0.5);
    scene.membrane.warp_stiffness = scene.membrane.weft_stiffness = 5000.0;
    scene.solver.residual_tolerance = 1e-6;
    scene.wind = WindOptions{{0, 0, 2.0}, 1.2, 1.2, 1.2};
    const DrapeResult result = Draper(scene).drape_neutral();
    ASSERT_LE(result.certificate.residual_force, 1e-6);
    // Pressure p cos α along the normal, weight w down; a plate turns until the moments balance: p cos α = w sin α.
    const double pressure = 0.5 * 1.2 * 1.2 * 4.0, expected = std::atan(pressure / 9.81);
    const double found = std::atan2(result.position.row(6).z(), 0.5 - result.position.row(6).y());
    EXPECT_NEAR(found / expected, 1.0, 0.02);
}

}  // namespace
}  // namespace toile::simulate

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cloth/bending.h"
#include "cloth/membrane.h"
#include "simulate/certificate.h"
#include "simulate/spring_network.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

struct Fixture {
    ClothMesh mesh = test::cloth_square(8, 0.2, 0.0);
    Topology topology = build_topology(mesh.triangle);
    Eigen::VectorXd rest_length = edge_rest_lengths(mesh, topology);
};

double spring_energy(const std::vector<Spring>& springs, const Positions& x) {
    double energy = 0.0;
    for (const Spring& s : springs) {
        const double stretch = (x.row(s.first) - x.row(s.second)).norm() - s.rest_length;
        energy += 0.5 * s.stiffness * stretch * stretch;
    }
    return energy;
}

double membrane_energy_of(const ClothMesh& mesh, const MembraneOptions& o, const Positions& x) {
    const MembraneStiffness c =
        MembraneStiffness::from_moduli(o.weft_stiffness, o.warp_stiffness, o.shear_stiffness, o.poisson_ratio);
    double energy = 0.0;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        TrianglePositions corners;
        for (int i = 0; i < 3; ++i) corners.col(i) = x.row(mesh.triangle(f, i)).transpose();
        energy += membrane_energy(membrane_stencil(mesh, f), c, corners);
    }
    return energy;
}

/// The square strained evenly in its plane; u is x, v is -z.
Positions strained(const Positions& x, double uu, double vv, double uv) {
    Positions y = x;
    for (int i = 0; i < x.rows(); ++i) {
        const double u = x(i, 0), v = -x(i, 2);
        y(i, 0) = u + uu * u + uv * v;
        y(i, 2) = -(v + uv * u + vv * v);
    }
    return y;
}

TEST(SpringNetwork, StandsForAMembraneWithCauchysSymmetry) {
    // With the coupling equal to the shear stiffness, right triangles fit the membrane exactly.
    Fixture f;
    MembraneOptions options;
    options.warp_stiffness = 800.0;
    options.weft_stiffness = 1250.0;
    options.poisson_ratio = 0.25;
    options.shear_stiffness = 0.25 * std::sqrt(800.0 * 1250.0) / (1.0 - 0.25 * 0.25);
    const std::vector<Spring> springs = membrane_springs(f.mesh, f.topology, f.rest_length, options);
    const double e = 1e-5;
    for (const auto& [uu, vv, uv] : {std::array{e, 0.0, 0.0}, {0.0, e, 0.0}, {e, -e, 0.0}, {0.0, 0.0, e}}) {
        const Positions x = strained(f.mesh.rest_position, uu, vv, uv);
        const double wanted = membrane_energy_of(f.mesh, options, x);
        EXPECT_NEAR(spring_energy(springs, x), wanted, 1e-3 * wanted) << uu << ' ' << vv << ' ' << uv;
    }
}

TEST(SpringNetwork, RestLengthsAreThePatternsNotTheStarts) {
    Fixture f;
    f.mesh.rest_position *= 3.0;
    for (const Spring& s : membrane_springs(f.mesh, f.topology, f.rest_length, {}))
        EXPECT_NEAR(s.rest_length,
                    (f.mesh.pattern_position.row(s.first) - f.mesh.pattern_position.row(s.second)).norm(), 1e-15);
    for (const Spring& s : bending_springs(f.mesh, f.topology, {}))
        EXPECT_NEAR(s.rest_length,
                    (f.mesh.pattern_position.row(s.first) - f.mesh.pattern_position.row(s.second)).norm(), 1e-15);
}

TEST(SpringNetwork, EveryEdgeHasAStiffnessAndItScalesWithTheMaterial) {
    Fixture f;
    MembraneOptions stiff;
    stiff.warp_stiffness = stiff.weft_stiffness = 1e7;
    stiff.shear_stiffness = 3e6;
    const auto soft_springs = membrane_springs(f.mesh, f.topology, f.rest_length, {});
    const auto stiff_springs = membrane_springs(f.mesh, f.topology, f.rest_length, stiff);
    ASSERT_EQ(soft_springs.size(), static_cast<size_t>(f.topology.edge.rows()));
    for (size_t e = 0; e < soft_springs.size(); ++e) {
        EXPECT_GT(soft_springs[e].stiffness, 0.0);
        EXPECT_NEAR(stiff_springs[e].stiffness, 1e4 * soft_springs[e].stiffness, 1e-9 * stiff_springs[e].stiffness);
    }
}

/// Two right triangles that share the side from (0, 0) to (0, 0.02), folded there.
struct Hinge {
    ClothMesh mesh;
    Topology topology;

    explicit Hinge(double fold) {
        mesh.pattern_position.resize(4, 2);
        mesh.pattern_position << 0, 0, 0, 0.02, -0.013, 0.004, 0.02, 0.011;
        mesh.triangle.resize(2, 3);
        mesh.triangle << 0, 1, 2, 0, 3, 1;
        mesh.pattern_triangle = mesh.triangle;
        mesh.rest_position.resize(4, 3);
        mesh.rest_position << 0, 0, 0, 0, 0.02, 0, -0.013, 0.004, 0, 0.02 * std::cos(fold), 0.011,
            0.02 * std::sin(fold);
        topology = build_topology(mesh.triangle);
    }
};

TEST(SpringNetwork, ABendingSpringStoresTheHingesEnergyAtOneRadian) {
    const Hinge f(1.0);
    const BendingOptions options{3e-5};
    const std::vector<Spring> springs = bending_springs(f.mesh, f.topology, options);
    ASSERT_EQ(springs.size(), 1u);
    EXPECT_EQ(std::min(springs[0].first, springs[0].second), 2);
    EXPECT_EQ(std::max(springs[0].first, springs[0].second), 3);
    EXPECT_NEAR(springs[0].rest_length, std::hypot(0.033, 0.007), 1e-15);

    int shared = 0;
    while (f.topology.edge_triangle(shared, 1) < 0) ++shared;
    const Eigen::Vector4i hinge = build_hinges(f.topology, f.mesh.triangle).row(0).transpose();
    HingePositions columns;
    for (int i = 0; i < 4; ++i) columns.col(i) = f.mesh.rest_position.row(hinge[i]).transpose();
    const double wanted = bending_energy(
        bending_stencil(f.mesh, hinge, f.topology.edge_triangle(shared, 0), f.topology.edge_triangle(shared, 1)),
        options.stiffness, columns);
    EXPECT_NEAR(spring_energy(springs, f.mesh.rest_position), wanted, 1e-9 * wanted);
}

TEST(SpringNetwork, ABendingSpringRestsAtTheStartsAngleWhereAsked) {
    for (const double fold : {-0.7, 0.4}) {
        const Hinge f(fold);
        const auto springs = bending_springs(f.mesh, f.topology, {3e-5, BendingRest::start});
        EXPECT_NEAR(springs[0].rest_length, (f.mesh.rest_position.row(2) - f.mesh.rest_position.row(3)).norm(), 1e-12);
    }
}

}  // namespace
}  // namespace toile::simulate

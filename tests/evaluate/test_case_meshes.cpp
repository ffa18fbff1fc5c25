#include <gtest/gtest.h>

#include <algorithm>

#include "cloth/topology.h"
#include "evaluate/case_meshes.h"
#include "evaluate/stability_cases.h"

namespace toile::evaluate {
namespace {

/// Longest over shortest edge of the mesh.
double edge_ratio(const ClothMesh& mesh) {
    double shortest = 1e9, longest = 0.0;
    const Topology topology = build_topology(mesh.triangle);
    for (Eigen::Index e = 0; e < topology.edge.rows(); ++e) {
        const double length =
            (mesh.rest_position.row(topology.edge(e, 0)) - mesh.rest_position.row(topology.edge(e, 1))).norm();
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
    }
    return longest / shortest;
}

TEST(CaseMeshes, AGridIsAClothOfItsArea) {
    const ClothMesh mesh = grid_cloth(even_lines(4, 0.4), even_lines(3, 0.3), 1.0, 0.5);
    EXPECT_NO_THROW(check_cloth_mesh(mesh, "grid"));
    EXPECT_EQ(mesh.vertex_count(), 20);
    EXPECT_EQ(mesh.triangle_count(), 24);
    EXPECT_NEAR(mesh.mass.sum(), 0.5 * 0.4 * 0.3, 1e-12);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const Eigen::RowVector3d a = mesh.rest_position.row(mesh.triangle(f, 0)),
                                 b = mesh.rest_position.row(mesh.triangle(f, 1)),
                                 c = mesh.rest_position.row(mesh.triangle(f, 2));
        EXPECT_GT((b - a).cross(c - a).y(), 0.0) << "triangle " << f << " faces down";
    }
}

TEST(CaseMeshes, ADiscGrowsItsEdgesThirtyfold) {
    const ClothMesh mesh = graded_disc(24, 0.01, 0.3, 0.0, 0.2);
    EXPECT_NO_THROW(check_cloth_mesh(mesh, "disc"));
    EXPECT_GT(edge_ratio(mesh), 30.0);
    EXPECT_LT(edge_ratio(mesh), 60.0) << "two kinds of edges, along and across, differ a little";
    EXPECT_NEAR(mesh.mass.sum(), 0.2 * 3.14159 * 0.09, 0.001);
}

TEST(CaseMeshes, AShakeIsSeededAndBounded) {
    const Positions zero = Positions::Zero(50, 3);
    Positions one = zero, again = zero, other = zero;
    shake(one, 0.5, 7);
    shake(again, 0.5, 7);
    shake(other, 0.5, 8);
    EXPECT_EQ(one, again);
    EXPECT_NE(one, other);
    EXPECT_LE(one.cwiseAbs().maxCoeff(), 0.5);
    EXPECT_GT(one.cwiseAbs().maxCoeff(), 0.4);
}

TEST(StabilityCases, MeshesReachTheExtremesTheyAreNamedFor) {
    bool needles = false, graded = false;
    for (const StabilityCase& one : stability_cases()) {
        if (one.name == "triangles of aspect 1000, on a table") {
            const ClothMesh mesh = one.build().drape.mesh;
            needles = edge_ratio(mesh) > 999.0;
        }
        if (one.name == "edges from 1 to 30 in one mesh, on a table")
            graded = edge_ratio(one.build().drape.mesh) > 30.0;
    }
    EXPECT_TRUE(needles);
    EXPECT_TRUE(graded);
}

TEST(StabilityCases, NamesAreUniqueAndGroupsStayTogether) {
    std::vector<std::string> name, group;
    for (const StabilityCase& one : stability_cases()) {
        name.push_back(one.name);
        if (group.empty() || group.back() != one.group) group.push_back(one.group);
    }
    std::sort(name.begin(), name.end());
    EXPECT_EQ(std::adjacent_find(name.begin(), name.end()), name.end());
    std::sort(group.begin(), group.end());
    EXPECT_EQ(std::adjacent_find(group.begin(), group.end()), group.end());
}

TEST(StabilityCases, AFastBodyTakesTheStepsItsSpeedSays) {
    for (const StabilityCase& one : stability_cases()) {
        if (one.name != "body speed 10 m/s, on a bending pillar") continue;
        const StabilityScene scene = one.build();
        // The pillar's top is half a metre from the joint.
        EXPECT_NEAR(scene.drape.schedule.joint_step, 10.0 * scene.drape.solver.time_step / 0.5, 0.02);
        return;
    }
    ADD_FAILURE() << "the case is gone";
}

}  // namespace
}  // namespace toile::evaluate

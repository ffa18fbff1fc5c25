#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "cloth/topology.h"
#include "evaluate/problem_meshes.h"
#include "prior/rest_state.h"

namespace toile::evaluate {
namespace {

struct Maker {
    std::string name;
    std::function<ClothMesh(Random&)> make;
};

const std::vector<Maker>& makers() {
    static const std::vector<Maker> all{
        {"tube", [](Random& random) { return open_tube(9, 7, 0.01, 0.2, random); }},
        {"patch", [](Random& random) { return flat_patch(8, 6, 0.01, 0.2, random); }},
        {"irregular", [](Random& random) { return irregular_patch(14, 11, 0.01, random); }},
        {"pieces", [](Random& random) { return several_pieces(100, 0.01, random); }},
        {"fin", [](Random& random) { return patch_with_fin(6, 5, 0.01, random); }},
    };
    return all;
}

std::vector<int> neighbour_counts(const ClothMesh& mesh) {
    std::vector<int> count(mesh.vertex_count(), 0);
    const Topology topology = build_topology(mesh.triangle);
    for (int v : topology.edge.reshaped()) ++count[v];
    return count;
}

TEST(ProblemMeshes, ThePapersTubeHasItsVerticesAndEdges) {
    Random random(1);
    const ClothMesh mesh = open_tube(53, 56, 0.015, 0.15, random);
    EXPECT_EQ(mesh.vertex_count(), 2968);
    EXPECT_EQ(build_topology(mesh.triangle).edge.rows(), 8798);
    EXPECT_EQ(boundary_loops(mesh.triangle).size(), 2u);
}

TEST(ProblemMeshes, EveryMeshHasARestState) {
    for (const Maker& maker : makers())
        for (int seed = 1; seed <= 5; ++seed) {
            Random random(seed);
            const ClothMesh mesh = maker.make(random);
            const prior::RestState rest = prior::rest_state(mesh, maker.name);
            EXPECT_GT(rest.edge_rest_length.minCoeff(), 1e-4) << maker.name;
            EXPECT_LT(rest.edge_rest_length.maxCoeff(), 0.06) << maker.name;
        }
}

TEST(ProblemMeshes, TheSeedAloneDecides) {
    for (const Maker& maker : makers()) {
        Random first(7), again(7), other(8);
        const ClothMesh a = maker.make(first), b = maker.make(again), c = maker.make(other);
        EXPECT_EQ(a.rest_position, b.rest_position) << maker.name;
        EXPECT_EQ(a.triangle, b.triangle) << maker.name;
        EXPECT_FALSE(a.rest_position.rows() == c.rest_position.rows() && a.rest_position == c.rest_position)
            << maker.name;
    }
}

TEST(ProblemMeshes, FlippedEdgesLeaveTheAreaAndChangeTheNeighbours) {
    Random random(3);
    const ClothMesh mesh = irregular_patch(20, 20, 1.0, random);
    double area = 0;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const Eigen::RowVector3d u =
            mesh.rest_position.row(mesh.triangle(f, 1)) - mesh.rest_position.row(mesh.triangle(f, 0));
        const Eigen::RowVector3d v =
            mesh.rest_position.row(mesh.triangle(f, 2)) - mesh.rest_position.row(mesh.triangle(f, 0));
        const double signed_area = 0.5 * (u[0] * v[1] - u[1] * v[0]);
        EXPECT_GT(signed_area, 0) << "triangle " << f;
        area += signed_area;
    }
    EXPECT_NEAR(area, 19.0 * 19.0, 12.0);
    EXPECT_LT(build_topology(mesh.triangle).non_manifold_edge, 0);
    const std::vector<int> count = neighbour_counts(mesh);
    EXPECT_GE(*std::max_element(count.begin(), count.end()), 8);
    EXPECT_LE(*std::min_element(count.begin(), count.end()), 4);
}

TEST(ProblemMeshes, AFinGivesEdgesWithThreeTriangles) {
    Random random(1);
    EXPECT_GE(build_topology(patch_with_fin(6, 5, 0.01, random).triangle).non_manifold_edge, 0);
}

TEST(ProblemMeshes, PiecesDoNotTouch) {
    Random random(1);
    const ClothMesh mesh = several_pieces(100, 0.01, random);
    const std::vector<int> component = connected_components(mesh.triangle, mesh.vertex_count());
    EXPECT_GE(*std::max_element(component.begin(), component.end()), 1);
}

TEST(ProblemMeshes, NewNumbersAreThoseOfTheSameCloth) {
    Random random(1);
    const ClothMesh before = flat_patch(8, 6, 0.01, 0.2, random);
    ClothMesh after = before;
    renumber_vertices(after, random);
    EXPECT_NE(before.rest_position, after.rest_position);
    for (int f = 0; f < before.triangle_count(); ++f)
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(before.rest_position.row(before.triangle(f, k)), after.rest_position.row(after.triangle(f, k)));
}

}  // namespace
}  // namespace toile::evaluate

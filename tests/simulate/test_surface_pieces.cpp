#include <gtest/gtest.h>

#include <cstdlib>

#include "simulate/surface_pieces.h"
#include "tests/simulate/tangled_cloth.h"

namespace toile::simulate {
namespace {

/// Square of 11 x 11 vertices; vertex 11 j + i is in column i of row j.
struct Square {
    test::Surface surface = test::surface(test::cloth_square(10, 1.0, 0.0));
    Topology topology = build_topology(surface.triangle);
    VertexRing ring{topology, 121};
    std::vector<int> component = connected_components(surface.triangle, 121);
    SurfacePieces pieces{topology, ring, component};

    /// Edges between a vertex that `inside` holds for and one that it doesn't.
    template <class Predicate>
    std::vector<int> around(Predicate inside) const {
        std::vector<int> edges;
        for (int e = 0; e < topology.edge.rows(); ++e)
            if (inside(topology.edge(e, 0)) != inside(topology.edge(e, 1))) edges.push_back(e);
        return edges;
    }
    template <class Predicate>
    void expect_cut_off(Predicate inside) {
        for (int v = 0; v < 121; ++v) EXPECT_EQ(pieces.cut_off(v), inside(v)) << "vertex " << v;
    }
};

bool in_the_middle(int v) {
    return std::abs(v % 11 - 5) <= 1 && std::abs(v / 11 - 5) <= 2;
}
bool in_the_first_columns(int v) {
    return v % 11 < 3;
}

TEST(SurfacePieces, AClosedCurveCutsOffWhatItEncloses) {
    Square square;
    square.pieces.cut(square.around(in_the_middle), {});
    square.expect_cut_off(in_the_middle);
}

TEST(SurfacePieces, ACurveFromBorderToBorderCutsOffTheSmallerSide) {
    Square square;
    square.pieces.cut(square.around(in_the_first_columns), {});
    square.expect_cut_off(in_the_first_columns);
}

TEST(SurfacePieces, ACurveThatEndsWithinTheSurfaceCutsNothingOff) {
    Square square;
    std::vector<int> edges = square.around(in_the_first_columns);
    edges.resize(edges.size() / 2);
    square.pieces.cut(edges, {});
    square.expect_cut_off([](int) { return false; });
}

TEST(SurfacePieces, ACurveThatCrossesAnEdgeTwiceDoesNotPartItsEnds) {
    Square square;
    std::vector<int> edges = square.around(in_the_middle);
    edges.push_back(edges[0]);
    square.pieces.cut(edges, {});
    square.expect_cut_off([](int) { return false; });
}

TEST(SurfacePieces, ACurveMayPassThroughVertices) {
    Square square;
    const int gap = 5 * 11 + 7;  // just outside the middle: its edges inwards are not cut, but it is on the curve
    std::vector<int> edges;
    for (const int e : square.around(in_the_middle))
        if (square.topology.edge(e, 0) != gap && square.topology.edge(e, 1) != gap) edges.push_back(e);
    square.pieces.cut(edges, {});
    square.expect_cut_off([](int) { return false; });
    square.pieces.cut(edges, {gap});
    square.expect_cut_off(in_the_middle);
}

TEST(SurfacePieces, ForgetsTheCutBefore) {
    Square square;
    square.pieces.cut(square.around(in_the_middle), {3, 60});
    square.pieces.cut(square.around(in_the_first_columns), {});
    square.expect_cut_off(in_the_first_columns);
}

}  // namespace
}  // namespace toile::simulate

#pragma once

#include <vector>

#include "simulate/crossings.h"

namespace toile::simulate {

/// Vertices and edges around each vertex of a mesh, in compressed rows.
struct VertexRing {
    struct Spoke {
        int neighbour, edge;
    };
    std::vector<int> start;    ///< `[V + 1]`
    std::vector<Spoke> spoke;  ///< of vertex v: [start[v], start[v + 1])

    VertexRing(const Topology& topology, int vertex_count);
};

/// Which way a crossing edge has to go back.
struct CrossingSide {
    int contour;  ///< the chain of triangle pairs it belongs to
    int inner;    ///< end of the edge (0 or 1) on the smaller piece the contour cuts off, or -1 where it cuts off none
};

/// Global intersection analysis (Baraff, Witkin, Kass: Untangling cloth, 2003, section 3): chains crossings to contours
/// and tells on which side of its contour each edge's ends lie. A contour that is closed on a surface, or runs from
/// border to border, cuts a piece off; the smaller piece is the one that went through. One that ends within the surface
/// cuts off none. A contour that passes through vertices where the surface crosses its own neighbourhood (an armpit
/// beside its seam) is one closed curve, and what it encloses is both sheets' inner side.
std::vector<CrossingSide> contour_sides(const Topology& topology, const VertexRing& ring,
                                        const std::vector<int>& component, const std::vector<Crossing>& crossing);

}  // namespace toile::simulate

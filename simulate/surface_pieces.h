#pragma once

#include <numeric>
#include <vector>

#include "cloth/topology.h"

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

/// Finds the pieces that a curve cuts off a surface: all sides of the curve grow at the same pace, and one that has
/// nowhere left to grow, while another of its connected component still has, is a piece cut off. Of two sides that is
/// the smaller. Costs as much as the pieces are large, not as the mesh is.
class SurfacePieces {
  public:
    /// `component` of each vertex, as `connected_components` numbers them. All must outlive the object.
    SurfacePieces(const Topology& topology, const VertexRing& ring, const std::vector<int>& component);

    /// Cuts the mesh at `edges`, each listed once for each time the curve crosses it, and at the vertices that the
    /// curve passes through.
    void cut(const std::vector<int>& edges, const std::vector<int>& vertices);
    /// Whether a vertex is on a piece that the last cut has cut off.
    bool cut_off(int vertex);

  private:
    void forget();
    void change_growing(int component, int by);
    void plant(int vertex);
    void grow(int vertex);
    int root(int side);

    const Topology& topology_;
    const VertexRing& ring_;
    const std::vector<int>& component_;
    std::vector<int> side_of_;  // of each vertex, or one of the two below
    static constexpr int nobody = -1, on_curve = -2;
    std::vector<bool> cut_;     // of each edge
    std::vector<int> growing_;  // of each component: sides that still grow
    int contested_ = 0;         // components with more than one
    std::vector<int> edges_, vertices_, queue_;
    std::vector<int> parent_;   // of each side, by those it has met
    std::vector<int> pending_;  // of each side: vertices in the queue
    std::vector<bool> closed_;  // of each side
};

}  // namespace toile::simulate

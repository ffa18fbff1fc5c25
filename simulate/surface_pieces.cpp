#include "simulate/surface_pieces.h"

#include <algorithm>

namespace toile::simulate {

VertexRing::VertexRing(const Topology& topology, int vertex_count) : start(vertex_count + 1, 0) {
    for (int e = 0; e < topology.edge.rows(); ++e)
        for (int end = 0; end < 2; ++end) ++start[topology.edge(e, end) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    spoke.resize(start.back());
    std::vector<int> next(start.begin(), start.end() - 1);
    for (int e = 0; e < topology.edge.rows(); ++e)
        for (int end = 0; end < 2; ++end) spoke[next[topology.edge(e, end)]++] = {topology.edge(e, 1 - end), e};
}

SurfacePieces::SurfacePieces(const Topology& topology, const VertexRing& ring, const std::vector<int>& component)
    : topology_(topology),
      ring_(ring),
      component_(component),
      side_of_(component.size(), nobody),
      cut_(topology.edge.rows(), false),
      growing_(component.size(), 0) {}

void SurfacePieces::cut(const std::vector<int>& edges, const std::vector<int>& vertices) {
    forget();
    edges_ = edges;
    vertices_ = vertices;
    for (const int e : edges) cut_[e] = !cut_[e];
    for (const int v : vertices) side_of_[v] = on_curve;
    for (const int e : edges)
        for (int end = 0; end < 2; ++end) plant(topology_.edge(e, end));
    for (std::size_t head = 0; head < queue_.size() && contested_ > 0; ++head) grow(queue_[head]);
}

bool SurfacePieces::cut_off(int vertex) {
    return side_of_[vertex] >= 0 && closed_[root(side_of_[vertex])];
}

void SurfacePieces::forget() {
    for (const int e : edges_) cut_[e] = false;
    for (const int v : vertices_) side_of_[v] = nobody;
    for (const int v : queue_) {
        side_of_[v] = nobody;
        growing_[component_[v]] = 0;
    }
    queue_.clear();
    parent_.clear();
    pending_.clear();
    closed_.clear();
    contested_ = 0;
}

void SurfacePieces::change_growing(int component, int by) {
    contested_ -= static_cast<int>(growing_[component] > 1);
    growing_[component] += by;
    contested_ += static_cast<int>(growing_[component] > 1);
}

void SurfacePieces::plant(int vertex) {
    if (side_of_[vertex] != nobody) return;
    side_of_[vertex] = static_cast<int>(parent_.size());
    parent_.push_back(side_of_[vertex]);
    pending_.push_back(1);
    closed_.push_back(false);
    queue_.push_back(vertex);
    change_growing(component_[vertex], 1);
}

void SurfacePieces::grow(int vertex) {
    const int component = component_[vertex];
    if (growing_[component] <= 1) return;
    for (int k = ring_.start[vertex]; k < ring_.start[vertex + 1]; ++k) {
        const int other = ring_.spoke[k].neighbour, mine = root(side_of_[vertex]);
        if (cut_[ring_.spoke[k].edge] || side_of_[other] == on_curve) continue;
        if (side_of_[other] == nobody) {
            side_of_[other] = mine;
            ++pending_[mine];
            queue_.push_back(other);
        } else if (const int theirs = root(side_of_[other]); theirs != mine) {
            parent_[std::max(mine, theirs)] = std::min(mine, theirs);
            pending_[std::min(mine, theirs)] += pending_[std::max(mine, theirs)];
            change_growing(component, -1);
        }
    }
    const int mine = root(side_of_[vertex]);
    if (--pending_[mine] > 0 || growing_[component] <= 1) return;
    closed_[mine] = true;
    change_growing(component, -1);
}

int SurfacePieces::root(int side) {
    while (parent_[side] != side) side = parent_[side] = parent_[parent_[side]];
    return side;
}

}  // namespace toile::simulate

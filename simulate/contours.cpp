#include "simulate/contours.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

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

namespace {

/// Sets of small integers that merge.
class DisjointSets {
  public:
    explicit DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int add() {
        parent_.push_back(static_cast<int>(parent_.size()));
        return parent_.back();
    }
    int root(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// The smaller root stays.
    int merge(int i, int j) {
        const int a = root(i), b = root(j), low = std::min(a, b), high = std::max(a, b);
        parent_[high] = low;
        return low;
    }

  private:
    std::vector<int> parent_;
};

/// Crossings of the same pair of triangles are the ends of one piece of contour.
std::vector<int> chain(const Topology& topology, const std::vector<Crossing>& crossing) {
    std::vector<std::pair<std::int64_t, int>> ends;
    const std::int64_t triangle_count = topology.triangle_edge.rows();
    for (int c = 0; c < static_cast<int>(crossing.size()); ++c) {
        for (int side = 0; side < 2; ++side) {
            const int f = topology.edge_triangle(crossing[c].edge, side);
            if (f < 0) continue;
            const auto [low, high] = std::minmax(f, crossing[c].triangle);
            ends.emplace_back(low * triangle_count + high, c);
        }
    }
    std::sort(ends.begin(), ends.end());
    DisjointSets sets(static_cast<int>(crossing.size()));
    for (std::size_t k = 1; k < ends.size(); ++k)
        if (ends[k].first == ends[k - 1].first) sets.merge(ends[k].second, ends[k - 1].second);
    std::vector<int> contour(crossing.size());
    for (int c = 0; c < static_cast<int>(crossing.size()); ++c) contour[c] = sets.root(c);
    return contour;
}

/// Finds the pieces one contour cuts off, by growing all sides of it at the same pace: a side that has nowhere left to
/// grow while another of the same component still has is a piece cut off. Costs as much as the pieces are large.
class PieceSearch {
  public:
    PieceSearch(const VertexRing& ring, const std::vector<int>& component, int edge_count)
        : ring_(ring),
          component_(component),
          label_(component.size(), -1),
          cut_(edge_count, false),
          growing_(component.size(), 0) {}

    /// `edges` once for each time the contour crosses them.
    void search(const Topology& topology, const std::vector<int>& edges) {
        forget();
        for (const int e : edges) {
            cut_[e] = !cut_[e];
            touched_edges_.push_back(e);
        }
        for (const int e : edges)
            for (int end = 0; end < 2; ++end) plant(topology.edge(e, end));
        for (std::size_t head = 0; head < queue_.size() && open_components_ > 0; ++head) grow(queue_[head]);
    }

    bool inner(int vertex) { return label_[vertex] >= 0 && cut_off_[sets_.root(label_[vertex])]; }

  private:
    void forget() {
        for (const int e : touched_edges_) cut_[e] = false;
        for (const int v : queue_) {
            label_[v] = -1;
            growing_[component_[v]] = 0;
        }
        touched_edges_.clear();
        queue_.clear();
        sets_ = DisjointSets(0);
        pending_.clear();
        cut_off_.clear();
        open_components_ = 0;
    }
    void change_growing(int component, int by) {
        const bool was_open = growing_[component] > 1;
        growing_[component] += by;
        open_components_ += static_cast<int>(growing_[component] > 1) - static_cast<int>(was_open);
    }
    void plant(int vertex) {
        if (label_[vertex] >= 0) return;
        label_[vertex] = sets_.add();
        pending_.push_back(1);
        cut_off_.push_back(false);
        queue_.push_back(vertex);
        change_growing(component_[vertex], 1);
    }
    void grow(int vertex) {
        const int component = component_[vertex];
        if (growing_[component] <= 1) return;
        for (int k = ring_.start[vertex]; k < ring_.start[vertex + 1]; ++k) {
            if (cut_[ring_.spoke[k].edge]) continue;
            const int mine = sets_.root(label_[vertex]), other = ring_.spoke[k].neighbour;
            if (label_[other] < 0) {
                label_[other] = mine;
                ++pending_[mine];
                queue_.push_back(other);
            } else if (sets_.root(label_[other]) != mine) {
                const int theirs = sets_.root(label_[other]), kept = sets_.merge(mine, theirs);
                pending_[kept] = pending_[mine] + pending_[theirs];
                change_growing(component, -1);
            }
        }
        const int mine = sets_.root(label_[vertex]);
        if (--pending_[mine] > 0 || growing_[component] <= 1) return;
        cut_off_[mine] = true;
        change_growing(component, -1);
    }

    const VertexRing& ring_;
    const std::vector<int>& component_;
    std::vector<int> label_;
    std::vector<bool> cut_;
    std::vector<int> growing_;  // sides of each component that still grow
    std::vector<int> touched_edges_, queue_;
    DisjointSets sets_{0};
    std::vector<int> pending_;  // of each side: vertices in the queue
    std::vector<bool> cut_off_;
    int open_components_ = 0;
};

}  // namespace

std::vector<CrossingSide> contour_sides(const Topology& topology, const VertexRing& ring,
                                        const std::vector<int>& component, const std::vector<Crossing>& crossing) {
    const std::vector<int> contour = chain(topology, crossing);
    std::vector<int> order(crossing.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return contour[a] < contour[b]; });

    PieceSearch pieces(ring, component, static_cast<int>(topology.edge.rows()));
    std::vector<CrossingSide> side(crossing.size());
    std::vector<int> edges;
    for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
        edges.clear();
        for (; to < order.size() && contour[order[to]] == contour[order[from]]; ++to)
            edges.push_back(crossing[order[to]].edge);
        pieces.search(topology, edges);
        for (std::size_t k = from; k < to; ++k) {
            const int e = crossing[order[k]].edge;
            const bool first = pieces.inner(topology.edge(e, 0)), second = pieces.inner(topology.edge(e, 1));
            side[order[k]] = {contour[order[k]], first == second ? -1 : (first ? 0 : 1)};
        }
    }
    return side;
}

}  // namespace toile::simulate

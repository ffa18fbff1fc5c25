#include "simulate/contours.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace toile::simulate {

namespace {

/// Sets of crossings that merge; each member knows whether its edge is on the same sheet as its root's.
class Chains {
  public:
    explicit Chains(int count) : parent_(count), other_sheet_(count, false) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    struct Place {
        int root;
        bool other_sheet;
    };
    Place find(int c) {
        Place place{c, false};
        while (parent_[place.root] != place.root) {
            place.other_sheet ^= other_sheet_[place.root];
            place.root = parent_[place.root];
        }
        parent_[c] = place.root;
        other_sheet_[c] = place.other_sheet;
        return place;
    }
    /// The smaller root stays.
    void merge(int a, int b, bool on_other_sheets) {
        const Place first = find(a), second = find(b);
        if (first.root == second.root) return;
        const int kept = std::min(first.root, second.root), gone = std::max(first.root, second.root);
        parent_[gone] = kept;
        other_sheet_[gone] = first.other_sheet ^ second.other_sheet ^ on_other_sheets;
    }

  private:
    std::vector<int> parent_;
    std::vector<bool> other_sheet_;
};

/// A crossing as an end of the piece of contour in one pair of triangles.
struct End {
    std::int64_t pair;
    int crossing;
    bool edge_of_lower;  // the edge is the triangle's with the smaller index
};

std::vector<End> ends_by_pair(const Topology& topology, const std::vector<Crossing>& crossing) {
    std::vector<End> ends;
    const std::int64_t triangle_count = topology.triangle_edge.rows();
    for (int c = 0; c < static_cast<int>(crossing.size()); ++c) {
        for (int side = 0; side < 2; ++side) {
            const int f = topology.edge_triangle(crossing[c].edge, side), t = crossing[c].triangle;
            if (f >= 0) ends.push_back({std::min(f, t) * triangle_count + std::max(f, t), c, f < t});
        }
    }
    std::sort(ends.begin(), ends.end(),
              [](const End& a, const End& b) { return a.pair != b.pair ? a.pair < b.pair : a.crossing < b.crossing; });
    return ends;
}

/// Adds the vertices that the triangles of the crossing edge share with the crossed triangle.
void add_loop_vertices(const Triangles& triangle, const Topology& topology, const Crossing& crossing,
                       std::vector<int>& loop_vertex) {
    for (int side = 0; side < 2; ++side) {
        const int f = topology.edge_triangle(crossing.edge, side);
        for (int corner = 0; f >= 0 && corner < 3; ++corner)
            for (int other = 0; other < 3; ++other)
                if (triangle(f, corner) == triangle(crossing.triangle, other))
                    loop_vertex.push_back(triangle(f, corner));
    }
}

}  // namespace

std::vector<Contour> trace_contours(const Triangles& triangle, const Topology& topology,
                                    const std::vector<Crossing>& crossing) {
    const int count = static_cast<int>(crossing.size());
    Chains chains(count);
    const std::vector<End> ends = ends_by_pair(topology, crossing);
    for (std::size_t k = 1; k < ends.size(); ++k)
        if (ends[k].pair == ends[k - 1].pair)
            chains.merge(ends[k].crossing, ends[k - 1].crossing, ends[k].edge_of_lower != ends[k - 1].edge_of_lower);

    std::vector<Contour> contours;
    std::vector<int> contour_of(count);
    for (int c = 0; c < count; ++c) {
        const Chains::Place place = chains.find(c);
        if (place.root == c) {
            contour_of[c] = static_cast<int>(contours.size());
            contours.emplace_back();
        }
        Contour& contour = contours[contour_of[place.root]];
        contour.crossing.push_back(c);
        contour.of_second.push_back(place.other_sheet);
        add_loop_vertices(triangle, topology, crossing[c], contour.loop_vertex);
    }
    return contours;
}

}  // namespace toile::simulate

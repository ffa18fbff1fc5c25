#include "pattern/refine.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::pattern {
namespace {

/// The lengths edges have in the pattern, the larger one at a seam.
Eigen::VectorXd largest_pattern_lengths(const ClothMesh& mesh, const Topology& topology) {
    Eigen::VectorXd length = Eigen::VectorXd::Zero(topology.edge.rows());
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d side = mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 1) % 3)) -
                                            mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 2) % 3));
            double& longest = length[topology.triangle_edge(f, k)];
            longest = std::max(longest, side.norm());
        }
    }
    return length;
}

/// The corner opposite a triangle's longest edge; of equal ones the edge with the larger number, which both its
/// triangles agree on.
int longest_side(const Topology& topology, const Eigen::VectorXd& length, int f) {
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
        const int e = topology.triangle_edge(f, k), best = topology.triangle_edge(f, longest);
        if (std::make_pair(length[e], e) > std::make_pair(length[best], best)) longest = k;
    }
    return longest;
}

/// Edges to divide: those that are too long, and the longest of each triangle that has one to divide.
std::vector<bool> mark(const Topology& topology, const Eigen::VectorXd& length, double edge_length) {
    std::vector<bool> marked(static_cast<size_t>(length.size()));
    for (int e = 0; e < length.size(); ++e) marked[e] = length[e] > edge_length;
    for (bool changed = true; changed;) {
        changed = false;
        for (int f = 0; f < topology.triangle_edge.rows(); ++f) {
            bool any = false;
            for (int k = 0; k < 3; ++k) any = any || marked[topology.triangle_edge(f, k)];
            const int longest = topology.triangle_edge(f, longest_side(topology, length, f));
            if (!any || marked[longest]) continue;
            marked[longest] = changed = true;
        }
    }
    return marked;
}

struct Corner {
    int vertex, pattern;
};

/// One pass: divides all marked edges.
class Divider {
  public:
    Divider(Garment& garment, const Topology& topology, const Eigen::VectorXd& length, const std::vector<bool>& marked)
        : garment_(garment), mesh_(garment.mesh), topology_(topology), length_(length), marked_(marked) {}

    void run() {
        middle_.assign(static_cast<size_t>(topology_.edge.rows()), -1);
        for (int v = 0; v < mesh_.vertex_count(); ++v) space_.emplace_back(mesh_.rest_position.row(v));
        for (int p = 0; p < mesh_.pattern_position.rows(); ++p) flat_.emplace_back(mesh_.pattern_position.row(p));
        for (int f = 0; f < mesh_.triangle_count(); ++f) divide(f);
        mesh_.rest_position.resize(static_cast<int>(space_.size()), 3);
        for (size_t v = 0; v < space_.size(); ++v) mesh_.rest_position.row(static_cast<int>(v)) = space_[v];
        mesh_.pattern_position.resize(static_cast<int>(flat_.size()), 2);
        for (size_t p = 0; p < flat_.size(); ++p) mesh_.pattern_position.row(static_cast<int>(p)) = flat_[p];
        mesh_.triangle.resize(static_cast<int>(rows_.size()), 3);
        mesh_.pattern_triangle.resize(static_cast<int>(rows_.size()), 3);
        for (int f = 0; f < static_cast<int>(rows_.size()); ++f) {
            for (int k = 0; k < 3; ++k) {
                mesh_.triangle(f, k) = rows_[f][k].vertex;
                mesh_.pattern_triangle(f, k) = rows_[f][k].pattern;
            }
        }
        garment_.triangle_panel = std::move(panel_);
    }

  private:
    Corner middle(int e, const Corner& a, const Corner& b) {
        if (middle_[e] < 0) {
            middle_[e] = static_cast<int>(space_.size());
            space_.emplace_back(0.5 * (space_[a.vertex] + space_[b.vertex]));
        }
        const auto [place, is_new] =
            pattern_middle_.try_emplace(std::minmax(a.pattern, b.pattern), static_cast<int>(flat_.size()));
        if (is_new) flat_.emplace_back(0.5 * (flat_[a.pattern] + flat_[b.pattern]));
        return {middle_[e], place->second};
    }

    void keep(int panel, const Corner& a, const Corner& b, const Corner& c) {
        rows_.push_back({a, b, c});
        panel_.push_back(panel);
    }

    /// Halves a triangle at its longest edge, then each half at the one edge it has left to divide.
    void divide(int f) {
        const int panel = garment_.triangle_panel[f], k = longest_side(topology_, length_, f);
        const int base = topology_.triangle_edge(f, k), edge_a = topology_.triangle_edge(f, (k + 1) % 3),
                  edge_b = topology_.triangle_edge(f, (k + 2) % 3);
        std::array<Corner, 3> c;
        for (int i = 0; i < 3; ++i) c[i] = {mesh_.triangle(f, (k + i) % 3), mesh_.pattern_triangle(f, (k + i) % 3)};
        if (!marked_[base]) return keep(panel, c[0], c[1], c[2]);
        // The longest edge runs from c[1] to c[2]; edge_b joins c[0] and c[1], edge_a joins c[2] and c[0].
        const Corner m = middle(base, c[1], c[2]);
        if (marked_[edge_b]) {
            const Corner n = middle(edge_b, c[0], c[1]);
            keep(panel, c[0], n, m);
            keep(panel, n, c[1], m);
        } else {
            keep(panel, c[0], c[1], m);
        }
        if (marked_[edge_a]) {
            const Corner n = middle(edge_a, c[2], c[0]);
            keep(panel, c[0], m, n);
            keep(panel, n, m, c[2]);
        } else {
            keep(panel, c[0], m, c[2]);
        }
    }

    Garment& garment_;
    ClothMesh& mesh_;
    const Topology& topology_;
    const Eigen::VectorXd& length_;
    const std::vector<bool>& marked_;
    std::vector<int> middle_;
    std::map<std::pair<int, int>, int> pattern_middle_;
    std::vector<Eigen::RowVector3d> space_;
    std::vector<Eigen::RowVector2d> flat_;
    std::vector<std::array<Corner, 3>> rows_;
    std::vector<int> panel_;
};

}  // namespace

void refine(Garment& garment, double edge_length, int max_triangles) {
    while (true) {
        const Topology topology = build_topology(garment.mesh.triangle);
        const Eigen::VectorXd length = largest_pattern_lengths(garment.mesh, topology);
        if (!(length.maxCoeff() > edge_length)) return;
        Divider(garment, topology, length, mark(topology, length, edge_length)).run();
        if (garment.mesh.triangle_count() > max_triangles)
            throw Error("refining the garment to an edge length of " + std::to_string(edge_length) +
                        " m makes more than " + std::to_string(max_triangles) + " triangles");
    }
}

}  // namespace toile::pattern

#include "pattern/sewing.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "cloth/error.h"

namespace toile::pattern {
namespace {

/// Numbers of points over all panels, joined along seams.
class Welds {
  public:
    explicit Welds(int count) : parent_(static_cast<size_t>(count)) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int p) {
        while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
        return p;
    }
    void join(int a, int b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<int> parent_;
};

std::vector<int> first_points(const std::vector<PanelMesh>& mesh) {
    std::vector<int> first = {0};
    for (const PanelMesh& m : mesh) first.push_back(first.back() + static_cast<int>(m.position.rows()));
    return first;
}

/// The welded vertex of each pattern point, numbered in order of first appearance.
std::vector<int> weld(const std::vector<Panel>& panel, const std::vector<Seam>& seam, const std::vector<int>& first,
                      int& vertex_count) {
    Welds welds(first.back());
    for (const Seam& s : seam) {
        const std::vector<int> one = side_points(panel[s.panel], s.side);
        const std::vector<int> other = side_points(panel[s.other_panel], s.other_side);
        if (one.size() != other.size())
            throw Error("seam between " + panel[s.panel].side[s.side].name + " of " + panel[s.panel].name + " and " +
                        panel[s.other_panel].side[s.other_side].name + " of " + panel[s.other_panel].name + " joins " +
                        std::to_string(one.size()) + " points to " + std::to_string(other.size()));
        for (size_t i = 0; i < one.size(); ++i)
            welds.join(first[s.panel] + one[i], first[s.other_panel] + other[other.size() - 1 - i]);
    }
    std::vector<int> vertex(static_cast<size_t>(first.back()));
    vertex_count = 0;
    for (int p = 0; p < first.back(); ++p) vertex[p] = welds.find(p) == p ? vertex_count++ : vertex[welds.find(p)];
    return vertex;
}

}  // namespace

PlanePositions outline(const Panel& panel) {
    int count = 0;
    for (const PanelSide& side : panel.side) count += static_cast<int>(side.line.rows()) - 1;
    PlanePositions points(count, 2);
    int row = 0;
    for (const PanelSide& side : panel.side) {
        points.middleRows(row, side.line.rows() - 1) = side.line.topRows(side.line.rows() - 1);
        row += static_cast<int>(side.line.rows()) - 1;
    }
    return points;
}

std::vector<int> side_points(const Panel& panel, int side) {
    int start = 0, count = 0;
    for (int s = 0; s < static_cast<int>(panel.side.size()); ++s) {
        if (s < side) start += static_cast<int>(panel.side[s].line.rows()) - 1;
        count += static_cast<int>(panel.side[s].line.rows()) - 1;
    }
    std::vector<int> points(static_cast<size_t>(panel.side[side].line.rows()));
    for (size_t i = 0; i < points.size(); ++i) points[i] = (start + static_cast<int>(i)) % count;
    return points;
}

void lay_apart(PlanePositions& pattern_position, const std::vector<int>& pattern_panel, double gap) {
    const int panels = pattern_panel.empty() ? 0 : 1 + *std::max_element(pattern_panel.begin(), pattern_panel.end());
    double start = 0.0;
    for (int panel = 0; panel < panels; ++panel) {
        Eigen::RowVector2d lower = Eigen::RowVector2d::Constant(std::numeric_limits<double>::infinity());
        Eigen::RowVector2d upper = -lower;
        for (size_t p = 0; p < pattern_panel.size(); ++p) {
            if (pattern_panel[p] != panel) continue;
            lower = lower.cwiseMin(pattern_position.row(static_cast<int>(p)));
            upper = upper.cwiseMax(pattern_position.row(static_cast<int>(p)));
        }
        for (size_t p = 0; p < pattern_panel.size(); ++p)
            if (pattern_panel[p] == panel)
                pattern_position.row(static_cast<int>(p)) += Eigen::RowVector2d(start, 0.0) - lower;
        start += upper.x() - lower.x() + gap;
    }
}

Garment sew(const std::vector<Panel>& panel, const std::vector<PanelMesh>& mesh, const std::vector<Seam>& seam,
            const std::vector<Positions>& position, double gap) {
    const std::vector<int> first = first_points(mesh);
    int vertex_count = 0;
    const std::vector<int> vertex = weld(panel, seam, first, vertex_count);

    Garment garment;
    ClothMesh& cloth = garment.mesh;
    cloth.pattern_position.resize(first.back(), 2);
    cloth.rest_position = Positions::Zero(vertex_count, 3);
    std::vector<int> pattern_panel(vertex.size()), copies(static_cast<size_t>(vertex_count), 0);
    for (size_t p = 0; p < mesh.size(); ++p) {
        cloth.pattern_position.middleRows(first[p], mesh[p].position.rows()) = mesh[p].position;
        for (int i = 0; i < mesh[p].position.rows(); ++i) {
            pattern_panel[first[p] + i] = static_cast<int>(p);
            cloth.rest_position.row(vertex[first[p] + i]) += position[p].row(i);
            ++copies[vertex[first[p] + i]];
        }
        garment.panel_name.push_back(panel[p].name);
        garment.triangle_panel.insert(garment.triangle_panel.end(), static_cast<size_t>(mesh[p].triangle.rows()),
                                      static_cast<int>(p));
    }
    for (int v = 0; v < vertex_count; ++v) cloth.rest_position.row(v) /= copies[v];
    cloth.pattern_triangle.resize(static_cast<int>(garment.triangle_panel.size()), 3);
    int row = 0;
    for (size_t p = 0; p < mesh.size(); ++p)
        for (int f = 0; f < mesh[p].triangle.rows(); ++f, ++row)
            cloth.pattern_triangle.row(row) = mesh[p].triangle.row(f).array() + first[p];
    cloth.triangle = cloth.pattern_triangle.unaryExpr([&](int p) { return vertex[p]; });
    lay_apart(cloth.pattern_position, pattern_panel, gap);
    return garment;
}

}  // namespace toile::pattern

#include "simulate/crossings.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

#include "cloth/error.h"
#include "simulate/box_tree.h"

namespace toile::simulate {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

/// Boxes around edges and triangles, relative to the middle of the mesh, which the boxes' floats resolve best.
class Boxes {
  public:
    explicit Boxes(const Positions& x) {
        std::vector<double> value(x.rows());
        const auto quantile = [&](double share) {
            const auto nth = value.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(x.rows() - 1));
            std::nth_element(value.begin(), nth, value.end());
            return *nth;
        };
        for (int k = 0; k < 3 && x.rows() > 0; ++k) {
            for (Eigen::Index v = 0; v < x.rows(); ++v) value[v] = x(v, k);
            middle_[k] = quantile(0.5);
        }
        for (Eigen::Index v = 0; v < x.rows(); ++v) value[v] = (x.row(v) - middle_).cwiseAbs().maxCoeff();
        if (x.rows() > 0) reach_ = static_cast<float>(std::min(quantile(0.9), largest));
        for (Eigen::Index v = 0; v < x.rows(); ++v) vertex_.push_back(around_point(x.row(v) - middle_));
    }

    /// A tree of the boxes of features with the vertices in the rows of `feature`.
    template <class Rows>
    BoxTree tree(const Rows& feature) const {
        std::vector<Box> boxes;
        boxes.reserve(feature.rows());
        for (Eigen::Index f = 0; f < feature.rows(); ++f) {
            Box box = vertex_[feature(f, 0)];
            for (Eigen::Index k = 1; k < feature.cols(); ++k) box = around(box, vertex_[feature(f, k)]);
            box.widen(0.0f);
            boxes.push_back(box);
        }
        BoxTree tree;
        tree.build(boxes, reach_);
        return tree;
    }

  private:
    static constexpr double largest = 1e37;  // of what is further away the boxes overlap

    static Box around_point(const Eigen::RowVector3d& point) {
        Box box = Box::empty();
        for (int k = 0; k < 3; ++k)
            box.low[k] = box.high[k] = static_cast<float>(std::clamp(point[k], -largest, largest));
        box.low[3] = box.high[3] = 0.0f;
        return box;
    }

    Eigen::RowVector3d middle_ = Eigen::RowVector3d::Zero();
    float reach_ = 0.0f;
    std::vector<Box> vertex_;
};

bool share_a_vertex(const Topology& topology, int e, const Triangles& triangle, int f) {
    for (int corner = 0; corner < 3; ++corner)
        if (triangle(f, corner) == topology.edge(e, 0) || triangle(f, corner) == topology.edge(e, 1)) return true;
    return false;
}

bool cross(const Point& a, const Point& b, const Point& p, const Point& q, const Point& r) {
    const CGAL::Orientation side_a = CGAL::orientation(p, q, r, a), side_b = CGAL::orientation(p, q, r, b);
    if (side_a == side_b && side_a != CGAL::COPLANAR) return false;
    return CGAL::do_intersect(Kernel::Triangle_3(p, q, r), Kernel::Segment_3(a, b));
}

}  // namespace

std::vector<Crossing> find_crossings(const Triangles& triangle, const Topology& topology, const Positions& position) {
    if (!position.allFinite()) throw Error("crossings of a mesh with positions that are not finite");
    std::vector<Point> point;
    point.reserve(position.rows());
    for (int v = 0; v < position.rows(); ++v) point.emplace_back(position(v, 0), position(v, 1), position(v, 2));

    std::vector<Crossing> found;
    const Boxes boxes(position);
    boxes.tree(topology.edge).each_overlap(boxes.tree(triangle), [&](int e, int f) {
        if (!share_a_vertex(topology, e, triangle, f) &&
            cross(point[topology.edge(e, 0)], point[topology.edge(e, 1)], point[triangle(f, 0)], point[triangle(f, 1)],
                  point[triangle(f, 2)]))
            found.push_back({e, f});
        return true;
    });
    std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
    });
    return found;
}

}  // namespace toile::simulate

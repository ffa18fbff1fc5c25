#include "pattern/body_section.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace toile::pattern {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// The boundary of all points nearer than `offset` to a convex polygon, its round corners cut into short chords.
std::vector<Eigen::Vector2d> offset_polygon(const std::vector<Eigen::Vector2d>& polygon, double offset) {
    if (offset == 0.0) return polygon;
    std::vector<Eigen::Vector2d> moved;
    const size_t n = polygon.size();
    for (size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d in = polygon[i] - polygon[(i + n - 1) % n], out = polygon[(i + 1) % n] - polygon[i];
        const double turn = std::atan2(cross(in, out), in.dot(out));
        const int chords = 1 + static_cast<int>(turn / 0.15);
        const double start = std::atan2(-in.x(), in.y());  // direction of the outward normal of the edge coming in
        for (int k = 0; k <= chords; ++k) {
            const double angle = start + turn * k / chords;
            moved.emplace_back(polygon[i] + offset * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
        }
    }
    return moved;
}

}  // namespace

std::vector<Eigen::Vector2d> convex_hull(const std::vector<Eigen::Vector2d>& points) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
    std::vector<Point> in, out;
    for (const Eigen::Vector2d& p : points) in.emplace_back(p.x(), p.y());
    CGAL::convex_hull_2(in.begin(), in.end(), std::back_inserter(out));
    if (out.size() < 3) return {};
    std::vector<Eigen::Vector2d> hull;
    for (const Point& p : out) hull.emplace_back(p.x(), p.y());
    return hull;
}

TapeLoop::TapeLoop(const std::vector<Eigen::Vector2d>& points, double offset)
    : corner_(offset_polygon(convex_hull(points), offset)) {
    if (corner_.empty()) return;
    corner_.push_back(corner_.front());
    arc_.assign(corner_.size(), 0.0);
    for (size_t i = 1; i < corner_.size(); ++i) arc_[i] = arc_[i - 1] + (corner_[i] - corner_[i - 1]).norm();
}

Eigen::Vector2d TapeLoop::at(double s) const {
    s -= length() * std::floor(s / length());
    const size_t next =
        std::clamp<size_t>(std::upper_bound(arc_.begin(), arc_.end(), s) - arc_.begin(), 1, arc_.size() - 1);
    const double span = arc_[next] - arc_[next - 1];
    const double t = span > 0.0 ? (s - arc_[next - 1]) / span : 0.0;
    return (1.0 - t) * corner_[next - 1] + t * corner_[next];
}

double TapeLoop::leaves_at(const Eigen::Vector2d& from, const Eigen::Vector2d& direction) const {
    for (size_t i = 0; i + 1 < corner_.size(); ++i) {
        const double a = cross(direction, corner_[i] - from), b = cross(direction, corner_[i + 1] - from);
        // Counter-clockwise seen from inside, the loop crosses the ray from its right to its left.
        if (!(a < 0.0 && b >= 0.0)) continue;
        return arc_[i] + a / (a - b) * (arc_[i + 1] - arc_[i]);
    }
    return 0.0;
}

std::vector<Eigen::Vector3d> plane_section(const Triangles& triangle, const Positions& position,
                                           const Eigen::Vector3d& origin, const Eigen::Vector3d& normal) {
    const Eigen::VectorXd height = (position.rowwise() - origin.transpose()) * normal;
    std::vector<Eigen::Vector3d> points;
    for (int f = 0; f < triangle.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int a = triangle(f, k), b = triangle(f, (k + 1) % 3);
            if ((height[a] < 0.0) == (height[b] < 0.0)) continue;
            const double t = height[a] / (height[a] - height[b]);
            points.emplace_back((1.0 - t) * position.row(a) + t * position.row(b));
        }
    }
    return points;
}

}  // namespace toile::pattern

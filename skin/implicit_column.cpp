#include "skin/implicit_column.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace toile::skin {
namespace {

constexpr std::array<double Section::*, 5> fields = {&Section::side, &Section::front, &Section::back,
                                                     &Section::shift_side, &Section::shift_front};

/// Slopes that keep the cubic monotone between sections; zero at the ends, where the caps begin.
std::vector<Section> monotone_slopes(const std::vector<Section>& section) {
    std::vector<Section> slope(section.size(), Section{0, 0, 0, 0, 0, 0});
    for (size_t i = 1; i + 1 < section.size(); ++i)
        for (const auto field : fields) {
            const double before = section[i].at - section[i - 1].at, after = section[i + 1].at - section[i].at;
            const double left = (section[i].*field - section[i - 1].*field) / before;
            const double right = (section[i + 1].*field - section[i].*field) / after;
            if (left * right <= 0.0) continue;
            const double w = 2.0 * after + before, x = after + 2.0 * before;
            slope[i].*field = (w + x) / (w / left + x / right);
        }
    return slope;
}

/// The norm of (x, y), both at least zero, whose unit circle is the section, and its derivatives.
struct Across {
    double value, by_x, by_y;
};

Across ellipse(double x, double y) {
    const double norm = std::sqrt(x * x + y * y);
    return norm > 0.0 ? Across{norm, x / norm, y / norm} : Across{0.0, 0.0, 0.0};
}

Across superellipse(double x, double y, double exponent) {
    const double largest = std::max(x, y);
    if (largest <= 0.0) return {0.0, 0.0, 0.0};
    const double a = std::pow(x / largest, exponent - 1.0), b = std::pow(y / largest, exponent - 1.0);
    const double sum = (a * x + b * y) / largest, norm = std::pow(sum, 1.0 / exponent);
    return {largest * norm, a * norm / sum, b * norm / sum};
}

}  // namespace

ImplicitColumn::ImplicitColumn(const ColumnFrame& frame, std::vector<Section> sections, const ColumnCaps& caps,
                               double squareness)
    : origin_(frame.origin),
      section_(std::move(sections)),
      slope_(monotone_slopes(section_)),
      cap_(caps),
      squareness_(squareness) {
    along_ = frame.along.normalized();
    front_ = (frame.front - along_ * along_.dot(frame.front)).normalized();
    side_ = front_.cross(along_);
    reach_ = std::max(caps.start, caps.end);
    for (const Section& section : section_) {
        const double depth = std::max(section.front, section.back) + std::abs(section.shift_front);
        reach_ = std::max(reach_, std::hypot(section.side + std::abs(section.shift_side), depth));
    }
}

// Called millions of times for a body: by components, because Eigen's expressions are slow without optimisation.
ImplicitColumn::Local ImplicitColumn::to_local(const Eigen::Vector3d& point) const {
    const double* p = point.data();
    const double* o = origin_.data();
    const double x = p[0] - o[0], y = p[1] - o[1], z = p[2] - o[2];
    const auto along = [&](const Eigen::Vector3d& axis) {
        const double* a = axis.data();
        return a[0] * x + a[1] * y + a[2] * z;
    };
    return {along(side_), along(front_), along(along_)};
}

double ImplicitColumn::distance_bound(const Eigen::Vector3d& point) const {
    const Local local = to_local(point);
    const double first = section_.front().at, last = section_.back().at;
    const double beyond = local.along < first ? first - local.along : local.along > last ? local.along - last : 0.0;
    return std::sqrt(local.side * local.side + local.front * local.front + beyond * beyond) - reach_;
}

Section ImplicitColumn::section_at(double along) const {
    size_t i = 0;
    while (i + 2 < section_.size() && section_[i + 1].at <= along) ++i;
    const double length = section_[i + 1].at - section_[i].at;
    const double t = (along - section_[i].at) / length, t2 = t * t, t3 = t2 * t;
    const double a = 2 * t3 - 3 * t2 + 1, b = (t3 - 2 * t2 + t) * length, d = (t3 - t2) * length;
    Section section{};
    section.at = along;
    for (const auto field : fields)
        section.*field =
            a * section_[i].*field + (1 - a) * section_[i + 1].*field + b * slope_[i].*field + d * slope_[i + 1].*field;
    return section;
}

double ImplicitColumn::distance(const Eigen::Vector3d& point) const {
    const Local local = to_local(point);
    const double along = std::clamp(local.along, section_.front().at, section_.back().at);
    const Section section = section_at(along);
    const double side = local.side - section.shift_side, front = local.front - section.shift_front;
    const double beyond = local.along - along;
    const double depth = front > 0.0 ? section.front : section.back, cap = beyond > 0.0 ? cap_.end : cap_.start;
    // k is 1 on the surface; k - 1 over the length of its gradient is the distance to first order. The taper is left
    // out of the gradient: far from the axis it would distort more than it corrects.
    const double x = std::abs(side) / section.side, y = std::abs(front) / depth, z = beyond / cap;
    const Across across = squareness_ == 2.0 ? ellipse(x, y) : superellipse(x, y, squareness_);
    const double k = std::hypot(across.value, z);
    if (k < 1e-3) return -std::min(section.side, depth);
    const double by_side = across.value * across.by_x / section.side, by_front = across.value * across.by_y / depth;
    const double by_along = z / cap;
    const double slope = std::sqrt(by_side * by_side + by_front * by_front + by_along * by_along) / k;
    return (k - 1.0) / std::max(slope, 1e-6);
}

ImplicitColumn ImplicitColumn::mirrored() const {
    ImplicitColumn mirror = *this;
    mirror.origin_[0] = -origin_[0];
    mirror.side_[0] = -side_[0];
    mirror.front_[0] = -front_[0];
    mirror.along_[0] = -along_[0];
    return mirror;
}

double smooth_union(double a, double b, double blend) {
    const double near = std::max(blend - std::abs(a - b), 0.0) / blend;
    return std::min(a, b) - 0.25 * blend * near * near;
}

}  // namespace toile::skin

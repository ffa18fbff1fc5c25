#include "pattern/torso_wrap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloth/error.h"

namespace toile::pattern {
namespace {

constexpr int rise_samples = 33;
constexpr int columns_a_side = 9;

std::vector<Eigen::Vector2d> evenly(const std::vector<Eigen::Vector2d>& line, double& length) {
    std::vector<double> arc(line.size(), 0.0);
    for (size_t i = 1; i < line.size(); ++i) arc[i] = arc[i - 1] + (line[i] - line[i - 1]).norm();
    length = arc.back();
    std::vector<Eigen::Vector2d> even;
    size_t next = 1;
    for (int k = 0; k < rise_samples; ++k) {
        const double s = length * k / (rise_samples - 1);
        while (next + 1 < line.size() && arc[next] < s) ++next;
        const double span = arc[next] - arc[next - 1];
        const double t = span > 0.0 ? std::clamp((s - arc[next - 1]) / span, 0.0, 1.0) : 0.0;
        even.emplace_back((1.0 - t) * line[next - 1] + t * line[next]);
    }
    return even;
}

}  // namespace

TorsoWrap::TorsoWrap(const skin::Body& body, const BodyMeasure& measure, const Options& options)
    : options_(options), center_x_(measure.center_x), center_z_(measure.center_z) {
    const int levels = 2 + static_cast<int>(std::ceil((options.underarm_height - options.lowest_height) / level_step_));
    for (int i = 0; i < levels; ++i) {
        const double height = options.underarm_height - (levels - 1 - i) * level_step_;
        level_.push_back(convex_hull(trunk_section(body, measure.part, height)));
        if (level_.back().empty() && i > 0) level_.back() = level_[i - 1];
    }
    for (int i = levels - 2; i >= 0; --i)
        if (level_[i].empty()) level_[i] = level_[i + 1];
    for (const auto& hull : level_) tape_.push_back(TapeLoop(hull, 0.0).length());
    for (double side : {-1.0, 1.0}) {
        for (int k = 0; k < columns_a_side; ++k) {
            const double t = (side < 0 ? columns_a_side - 1 - k : k) / (columns_a_side - 1.0);
            const double x = side * (options.neck_half_width + t * (options.tip_half_width - options.neck_half_width));
            column_.push_back(make_column(body, measure, x));
        }
    }
}

double TorsoWrap::tape(double height) const {
    const double level = (height - options_.underarm_height) / level_step_ + static_cast<double>(level_.size() - 1);
    return tape_[static_cast<size_t>(std::clamp(std::round(level), 0.0, static_cast<double>(level_.size() - 1)))];
}

Eigen::Vector3d TorsoWrap::loop_point(double height, double share, double circumference) const {
    const double last = static_cast<double>(level_.size() - 1);
    const double level = std::clamp((height - options_.underarm_height) / level_step_ + last, 0.0, last);
    const int below = std::min(static_cast<int>(level), static_cast<int>(last) - 1);
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    for (int k = 0; k < 2; ++k) {
        const double offset =
            std::max(options_.clearance, (circumference - tape_[below + k]) / (2.0 * std::numbers::pi));
        const TapeLoop loop(level_[below + k], offset);
        const double start = loop.leaves_at({center_x_, center_z_}, {0.0, 1.0});
        // In the plane (x, z) the loop runs from the front to the wearer's right.
        const double weight = k == 0 ? 1.0 - (level - below) : level - below;
        point += weight * loop.at(start - share * loop.length());
    }
    return {point.x(), height, point.y()};
}

TorsoWrap::Column TorsoWrap::make_column(const skin::Body& body, const BodyMeasure& measure, double x) const {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& p :
         plane_section(measure.part.below_head, body.rest_position, {center_x_ + x, 0.0, 0.0}, {1.0, 0.0, 0.0}))
        if (p.y() > options_.underarm_height - 0.005) points.emplace_back(p.z(), p.y());
    const TapeLoop profile(points, options_.clearance);
    if (profile.corner().empty()) throw Error("the T-shirt cannot be cut: no shoulder was found above the armpit");
    Column column;
    column.x = x;
    const auto top = std::max_element(profile.corner().begin(), profile.corner().end(),
                                      [](const auto& a, const auto& b) { return a.y() < b.y(); });
    trace(profile, top->x(), column);
    return column;
}

void TorsoWrap::trace(const TapeLoop& profile, double ridge_z, Column& column) const {
    const auto& corner = profile.corner();
    const auto [hindmost, foremost] =
        std::minmax_element(corner.begin(), corner.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
    const double low = options_.underarm_height;
    for (int half = 0; half < 2; ++half) {
        // Straight up from the underarm line where the trunk is thickest, then along the hull to the ridge.
        const Eigen::Vector2d thickest = half == front ? *foremost : *hindmost;
        std::vector<Eigen::Vector2d> line = {{thickest.x(), low}};
        std::vector<Eigen::Vector2d> upper;
        for (const Eigen::Vector2d& p : corner) {
            const bool between = half == front ? p.x() > ridge_z : p.x() < ridge_z;
            if (between && p.y() > std::max(low, thickest.y() - 1e-9)) upper.push_back(p);
        }
        std::sort(upper.begin(), upper.end(), [&](const auto& a, const auto& b) {
            return half == front ? std::make_pair(-a.x(), a.y()) < std::make_pair(-b.x(), b.y())
                                 : std::make_pair(a.x(), a.y()) < std::make_pair(b.x(), b.y());
        });
        line.insert(line.end(), upper.begin(), upper.end());
        const double top = std::max_element(corner.begin(), corner.end(), [](const auto& a, const auto& b) {
                               return a.y() < b.y();
                           })->y();
        line.emplace_back(ridge_z, top);
        column.rise[half] = evenly(line, column.length[half]);
    }
}

double TorsoWrap::column_length(Half half, double x) const {
    const auto next = std::clamp<std::ptrdiff_t>(
        std::lower_bound(column_.begin(), column_.end(), x, [](const Column& c, double at) { return c.x < at; }) -
            column_.begin(),
        1, static_cast<std::ptrdiff_t>(column_.size()) - 1);
    const Column &a = column_[next - 1], &b = column_[next];
    const double t = std::clamp((x - a.x) / (b.x - a.x), 0.0, 1.0);
    return (1.0 - t) * a.length[half] + t * b.length[half];
}

Eigen::Vector3d TorsoWrap::yoke_point(Half half, double x, double share) const {
    const auto next = std::clamp<std::ptrdiff_t>(
        std::lower_bound(column_.begin(), column_.end(), x, [](const Column& c, double at) { return c.x < at; }) -
            column_.begin(),
        1, static_cast<std::ptrdiff_t>(column_.size()) - 1);
    const Column &a = column_[next - 1], &b = column_[next];
    const double t = std::clamp((x - a.x) / (b.x - a.x), 0.0, 1.0);
    const double at = std::clamp(share, 0.0, 1.0) * (rise_samples - 1);
    const int low = std::min(static_cast<int>(at), rise_samples - 2);
    auto along = [&](const Column& c) -> Eigen::Vector2d {
        return (1.0 - (at - low)) * c.rise[half][low] + (at - low) * c.rise[half][low + 1];
    };
    const Eigen::Vector2d p = (1.0 - t) * along(a) + t * along(b);
    return {center_x_ + x, p.y(), p.x()};
}

}  // namespace toile::pattern

#include "pattern/tshirt_placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile::pattern {
namespace {

using std::numbers::pi;

/// A point of the front or back panel on the trunk.
class TrunkPlacement {
  public:
    TrunkPlacement(const TorsoWrap& wrap, const TshirtDraft& draft, double underarm_height, double tip_half_width)
        : wrap_(wrap), draft_(draft), underarm_height_(underarm_height), tip_half_width_(tip_half_width) {}

    Eigen::Vector3d operator()(int half, double u, double v) const {
        const double down = std::clamp(-v / draft_.length_below, 0.0, 1.0);
        const double circumference = 4.0 * ((1.0 - down) * draft_.half_chest + down * draft_.half_hem);
        const double share = 0.5 * half + u / circumference;
        const double height = underarm_height_ + v;
        if (v <= 0.0) return wrap_.loop_point(height, share, circumference);
        Eigen::Vector3d around = wrap_.loop_point(underarm_height_, share, circumference);
        around.y() = height;
        const double t = std::clamp(v / (0.6 * draft_.tip_height[half]), 0.0, 1.0);
        const double blend = t * t * (3.0 - 2.0 * t);
        return (1.0 - blend) * around + blend * on_yoke(half, u, v);
    }

  private:
    Eigen::Vector3d on_yoke(int half, double u, double v) const {
        // The share of the way up to the shoulder seam above this point.
        const double across =
            std::clamp((draft_.half_tip - std::abs(u)) / (draft_.half_tip - draft_.half_neck), 0.0, 1.0);
        const double seam = draft_.tip_height[half] + across * draft_.shoulder_rise;
        const double left = half == 0 ? u : -u;
        return wrap_.yoke_point(half == 0 ? TorsoWrap::front : TorsoWrap::back,
                                left * tip_half_width_ / draft_.half_tip, v / seam);
    }

    const TorsoWrap& wrap_;
    const TshirtDraft& draft_;
    double underarm_height_, tip_half_width_;
};

/// A sleeve as a tube: from the armhole, a closed line over the angle around the arm, to rings around the arm.
class SleevePlacement {
  public:
    struct CapPoint {
        double angle, height;  // angle around the arm in (-pi, pi], 0 on top; v of the cap there
        Eigen::Vector3d position;
    };

    SleevePlacement(const ArmMeasure& arm, const TshirtDraft& draft, int plus_half, std::vector<CapPoint> cap)
        : arm_(arm), draft_(draft), plus_half_(plus_half), cap_(std::move(cap)) {
        std::sort(cap_.begin(), cap_.end(), [](const CapPoint& a, const CapPoint& b) { return a.angle < b.angle; });
        upper_ = (arm.elbow - arm.shoulder).norm();
        const double outwards = std::copysign(1.0, arm.elbow.x() - arm.shoulder.x());
        const Eigen::Vector3d along = (arm.elbow - arm.shoulder) / upper_, rough(0.6 * outwards, 1.0, 0.0);
        top_ = (rough - rough.dot(along) * along).normalized();
        const double tip = (at_angle(0.0).position - arm.shoulder).dot(along);
        last_station_ = std::max(0.0, tip) + draft.cap_height + draft.sleeve_below;
        first_station_ = std::min(last_station_, 0.55 * upper_);
    }

    double angle(double u, double v) const {
        const double narrowing = 1.0 + (1.0 - draft_.cuff_share) * v / draft_.sleeve_below;
        const double half = draft_.half_biceps[u > 0.0 ? plus_half_ : 1 - plus_half_] * narrowing;
        return std::clamp(pi * u / half, -pi, pi);
    }

    Eigen::Vector3d operator()(double u, double v) const {
        const double around = angle(u, v);
        const CapPoint from = at_angle(around);
        const double share = std::clamp((from.height - v) / (from.height + draft_.sleeve_below), 0.0, 1.0);
        const Eigen::Vector3d along = (arm_.elbow - arm_.shoulder) / upper_;
        const double start = std::min((from.position - arm_.shoulder).dot(along), first_station_ - 0.01);
        const double station = (1.0 - share) * start + share * last_station_;
        if (station >= first_station_) return ring(station, around, v);
        const double t = (station - start) / (first_station_ - start);
        return (1.0 - t) * from.position + t * ring(first_station_, around, v);
    }

  private:
    CapPoint at_angle(double angle) const {
        const auto next = std::upper_bound(cap_.begin(), cap_.end(), angle,
                                           [](double at, const CapPoint& point) { return at < point.angle; });
        if (next == cap_.begin()) return cap_.front();
        if (next == cap_.end()) return cap_.back();
        const CapPoint &a = *(next - 1), &b = *next;
        const double t = (angle - a.angle) / (b.angle - a.angle);
        return {angle, (1.0 - t) * a.height + t * b.height, (1.0 - t) * a.position + t * b.position};
    }

    Eigen::Vector3d ring(double station, double angle, double v) const {
        const Eigen::Vector3d bend = station <= upper_ ? arm_.elbow - arm_.shoulder : arm_.wrist - arm_.elbow;
        const Eigen::Vector3d along = bend.normalized(), top = (top_ - top_.dot(along) * along).normalized();
        const auto next = std::clamp<std::ptrdiff_t>(
            std::lower_bound(arm_.station.begin(), arm_.station.end(), station) - arm_.station.begin(), 1,
            static_cast<std::ptrdiff_t>(arm_.station.size()) - 1);
        const double span = arm_.station[next] - arm_.station[next - 1];
        const double t = (station - arm_.station[next - 1]) / span;
        const double inside = std::clamp(t, 0.0, 1.0);
        // Beyond the last section the arm goes on along its joints.
        const Eigen::Vector3d center =
            (1.0 - inside) * arm_.center[next - 1] + inside * arm_.center[next] + (t - inside) * span * along;
        const double tape = (1.0 - inside) * arm_.tape[next - 1] + inside * arm_.tape[next];
        const double narrowing = 1.0 + (1.0 - draft_.cuff_share) * v / draft_.sleeve_below;
        const double width = (draft_.half_biceps[0] + draft_.half_biceps[1]) * narrowing;
        const double radius = std::max(width, tape + 2.0 * pi * 0.008) / (2.0 * pi);
        return center + radius * (std::cos(angle) * top + std::sin(angle) * top.cross(along));
    }

    const ArmMeasure& arm_;
    const TshirtDraft& draft_;
    int plus_half_;
    std::vector<CapPoint> cap_;
    Eigen::Vector3d top_;
    double upper_, first_station_, last_station_;
};

}  // namespace

std::vector<Positions> place_tshirt(const BodyMeasure& measure, const TorsoWrap& wrap, double underarm_height,
                                    double tip_half_width, const TshirtDraft& draft, const std::vector<Panel>& panel,
                                    const std::vector<PanelMesh>& mesh) {
    std::vector<Positions> position(mesh.size());
    const TrunkPlacement on_trunk(wrap, draft, underarm_height, tip_half_width);
    for (int half = 0; half < 2; ++half) {
        const PlanePositions& flat = mesh[half].position;
        position[half].resize(flat.rows(), 3);
        for (int i = 0; i < flat.rows(); ++i) position[half].row(i) = on_trunk(half, flat(i, 0), flat(i, 1));
    }
    for (int side = 0; side < 2; ++side) {
        const int sleeve = left_sleeve + side, plus_half = 1 - side;
        const PlanePositions& flat = mesh[sleeve].position;
        std::vector<SleevePlacement::CapPoint> cap;
        const SleevePlacement angles(measure.arm[side], draft, plus_half, {{0.0, 0.0, measure.arm[side].shoulder}});
        // The cap's points lie where the armhole's lie: the seam's two sides have the same number of points.
        for (const Seam& seam : tshirt_seams()) {
            if (seam.other_panel != sleeve || seam.panel == sleeve) continue;
            const std::vector<int> hole = side_points(panel[seam.panel], seam.side);
            const std::vector<int> top = side_points(panel[sleeve], seam.other_side);
            for (size_t i = 0; i < top.size(); ++i) {
                const auto at = flat.row(top[i]);
                cap.push_back({angles.angle(at[0], at[1]), at[1],
                               position[seam.panel].row(hole[hole.size() - 1 - i]).transpose()});
            }
        }
        const SleevePlacement on_sleeve(measure.arm[side], draft, plus_half, cap);
        position[sleeve].resize(flat.rows(), 3);
        for (int i = 0; i < flat.rows(); ++i) position[sleeve].row(i) = on_sleeve(flat(i, 0), flat(i, 1));
    }
    return position;
}

}  // namespace toile::pattern

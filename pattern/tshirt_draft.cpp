#include "pattern/tshirt_draft.h"

#include <algorithm>
#include <cmath>

namespace toile::pattern {
namespace {

using Point = Eigen::RowVector2d;
using Curve = std::array<Point, 4>;  // cubic Bezier control points

Point on_curve(const Curve& c, double t) {
    const double s = 1.0 - t;
    return s * s * s * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t * t * t * c[3];
}

constexpr int curve_chords = 200;

double length(const Curve& curve) {
    double sum = 0.0;
    for (int i = 0; i < curve_chords; ++i)
        sum += (on_curve(curve, (i + 1.0) / curve_chords) - on_curve(curve, 1.0 * i / curve_chords)).norm();
    return sum;
}

Curve straight(const Point& a, const Point& b) {
    return {a, a + (b - a) / 3.0, a + 2.0 * (b - a) / 3.0, b};
}

/// Points of a curve, evenly spaced by arc length, in `pieces` pieces.
PlanePositions cut(const Curve& curve, int pieces) {
    std::vector<double> arc = {0.0};
    for (int i = 0; i < curve_chords; ++i)
        arc.push_back(arc.back() +
                      (on_curve(curve, (i + 1.0) / curve_chords) - on_curve(curve, 1.0 * i / curve_chords)).norm());
    PlanePositions line(pieces + 1, 2);
    for (int k = 0; k <= pieces; ++k) {
        const double s = arc.back() * k / pieces;
        const size_t next =
            std::clamp<size_t>(std::lower_bound(arc.begin(), arc.end(), s) - arc.begin(), 1, arc.size() - 1);
        const double t = (s - arc[next - 1]) / (arc[next] - arc[next - 1]);
        line.row(k) = on_curve(curve, (static_cast<double>(next) - 1.0 + t) / curve_chords);
    }
    line.row(0) = curve[0];
    line.row(pieces) = curve[3];
    return line;
}

Curve mirrored(const Curve& curve) {
    Curve other;
    for (int k = 0; k < 4; ++k) other[k] = {-curve[3 - k].x(), curve[3 - k].y()};
    return other;
}

/// From the underarm up to the shoulder tip, on the panel's +u side.
Curve armhole(const TshirtDraft& d, int half) {
    const double height = d.tip_height[half], depth = d.half_chest - d.half_tip;
    return {Point(d.half_chest, 0.0), Point(d.half_chest - 0.75 * depth, 0.02 * height),
            Point(d.half_tip - 0.02, 0.35 * height), Point(d.half_tip, height)};
}

/// From the underarm (half width, 0) up to the top of the cap (0, cap_height).
Curve cap(double half_biceps, double cap_height) {
    return {Point(half_biceps, 0.0), Point(0.62 * half_biceps, 0.08 * cap_height), Point(0.5 * half_biceps, cap_height),
            Point(0.0, cap_height)};
}

int pieces(double length, const TshirtDraft& d) {
    return std::max(2, static_cast<int>(std::lround(length / d.edge_length)));
}

Panel trunk_panel(const TshirtDraft& d, int half) {
    const double neck_height = d.tip_height[half] + d.shoulder_rise;
    const Point tip(d.half_tip, d.tip_height[half]), neck(d.half_neck, neck_height);
    const Point underarm(d.half_chest, 0.0), hem_corner(d.half_hem, -d.length_below);
    const Point middle(0.0, neck_height - d.neck_drop[half]);
    const Curve side = straight(hem_corner, underarm), shoulder = straight(tip, neck), hole = armhole(d, half);
    const Curve neck_plus = {neck, Point(0.95 * neck.x(), middle.y() + 0.35 * d.neck_drop[half]),
                             Point(0.55 * neck.x(), middle.y()), middle};
    const int side_pieces = pieces(length(side), d), shoulder_pieces = pieces(length(shoulder), d);
    const int hole_pieces = pieces(length(hole), d), neck_pieces = pieces(length(neck_plus), d);
    const PlanePositions one = cut(neck_plus, neck_pieces), other = cut(mirrored(neck_plus), neck_pieces);
    PlanePositions whole_neck(2 * neck_pieces + 1, 2);
    whole_neck << one, other.bottomRows(neck_pieces);
    const Curve hem_line = straight({-d.half_hem, -d.length_below}, hem_corner);
    return {half == 0 ? "front" : "back",
            {{"hem", cut(hem_line, pieces(length(hem_line), d))},
             {"+u side", cut(side, side_pieces)},
             {"+u armhole", cut(hole, hole_pieces)},
             {"+u shoulder", cut(shoulder, shoulder_pieces)},
             {"neckline", whole_neck},
             {"-u shoulder", cut(mirrored(shoulder), shoulder_pieces)},
             {"-u armhole", cut(mirrored(hole), hole_pieces)},
             {"-u side", cut(mirrored(side), side_pieces)}}};
}

/// `plus_half` is the half (0 front, 1 back) on the sleeve's +u side: the back on the left, the front on the right.
Panel sleeve_panel(const TshirtDraft& d, int plus_half) {
    const double plus = d.half_biceps[plus_half], minus = d.half_biceps[1 - plus_half];
    const Point corner_plus(d.cuff_share * plus, -d.sleeve_below), corner_minus(-d.cuff_share * minus, -d.sleeve_below);
    const Curve under_plus = straight(corner_plus, {plus, 0.0});
    const Curve under_minus = straight({-minus, 0.0}, corner_minus);
    const Curve cuff_line = straight(corner_minus, corner_plus);
    const int under_pieces = pieces(d.sleeve_below, d);
    return {plus_half == 1 ? "left sleeve" : "right sleeve",
            {{"cuff", cut(cuff_line, pieces(length(cuff_line), d))},
             {"underarm", cut(under_plus, under_pieces)},
             {"cap", cut(cap(plus, d.cap_height), pieces(armhole_length(d, plus_half), d))},
             {"cap", cut(mirrored(cap(minus, d.cap_height)), pieces(armhole_length(d, 1 - plus_half), d))},
             {"underarm", cut(under_minus, under_pieces)}}};
}

/// The half width that makes a cap of this height as long as `wanted`; the length grows with the width.
double solve_half_biceps(double wanted, double cap_height) {
    double low = 0.0, high = wanted;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (length(cap(middle, cap_height)) < wanted ? low : high) = middle;
    }
    return low;
}

}  // namespace

double armhole_length(const TshirtDraft& draft, int half) {
    return length(armhole(draft, half));
}

void fit_sleeve(TshirtDraft& draft, double half_biceps) {
    const double shorter = std::min(armhole_length(draft, 0), armhole_length(draft, 1));
    // A cap of about half its half width leaves room to lift the arm; a narrow armhole gets a flatter cap.
    for (double steepness = 0.55; steepness > 0.05; steepness -= 0.01) {
        double low = 0.0, high = shorter;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (length(cap(middle, steepness * middle)) < shorter ? low : high) = middle;
        }
        draft.cap_height = steepness * low;
        if (low >= half_biceps) break;
    }
    for (int half = 0; half < 2; ++half)
        draft.half_biceps[half] = solve_half_biceps(armhole_length(draft, half), draft.cap_height);
}

std::vector<Panel> cut_panels(const TshirtDraft& draft) {
    return {trunk_panel(draft, 0), trunk_panel(draft, 1), sleeve_panel(draft, 1), sleeve_panel(draft, 0)};
}

std::vector<Seam> tshirt_seams() {
    // On the back panel +u is the wearer's right.
    return {{front_panel, side_plus, back_panel, side_minus},
            {front_panel, side_minus, back_panel, side_plus},
            {front_panel, shoulder_plus, back_panel, shoulder_minus},
            {front_panel, shoulder_minus, back_panel, shoulder_plus},
            {front_panel, armhole_plus, left_sleeve, cap_minus},
            {back_panel, armhole_minus, left_sleeve, cap_plus},
            {back_panel, armhole_plus, right_sleeve, cap_minus},
            {front_panel, armhole_minus, right_sleeve, cap_plus},
            {left_sleeve, underarm_plus, left_sleeve, underarm_minus},
            {right_sleeve, underarm_plus, right_sleeve, underarm_minus}};
}

}  // namespace toile::pattern

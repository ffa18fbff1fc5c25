#pragma once

#include <array>
#include <vector>

#include "pattern/sewing.h"

namespace toile::pattern {

/// The numbers a T-shirt is cut by [m]. Pattern coordinates: v is up, 0 on the underarm line; u runs around the body
/// from the wearer's right over the front to the left, and on over the back to the right, so that triangles that are
/// counter-clockwise in the pattern are so on the outside.
struct TshirtDraft {
    double edge_length;
    double half_chest;        ///< half the width of a panel at the underarm line: a quarter of the circumference
    double half_hem;          ///< the same at the hem
    double length_below;      ///< from the underarm line to the hem
    double half_tip;          ///< from the middle to the shoulder tip
    double half_neck;         ///< from the middle to the neck point
    double shoulder_rise;     ///< from the tip up to the neck point
    double tip_height[2];     ///< of the shoulder tip above the underarm line, front and back
    double neck_drop[2];      ///< of the neckline's middle below the neck point, front and back
    double half_biceps[2];    ///< sleeve: from its middle line to the underarm, on the front's and the back's side
    double cap_height;        ///< sleeve: from the underarm line to the top of the cap
    double sleeve_below;      ///< sleeve: from the underarm line to the cuff
    double cuff_share = 0.9;  ///< cuff over biceps width
};

/// Sides of the front and back panels and of the sleeves, in order.
enum TrunkSide { hem, side_plus, armhole_plus, shoulder_plus, neckline, shoulder_minus, armhole_minus, side_minus };
enum SleeveSide { cuff, underarm_plus, cap_plus, cap_minus, underarm_minus };
enum TshirtPanel { front_panel, back_panel, left_sleeve, right_sleeve };

/// Length of the armhole of one half (0 front, 1 back).
double armhole_length(const TshirtDraft& draft, int half);

/// Sets cap height and biceps widths so that the cap is as long as the armhole; `half_biceps` [m] is the narrowest half
/// width that fits the arm.
void fit_sleeve(TshirtDraft& draft, double half_biceps);

/// The four panels, in the order of `TshirtPanel`, and their seams.
std::vector<Panel> cut_panels(const TshirtDraft& draft);
std::vector<Seam> tshirt_seams();

}  // namespace toile::pattern

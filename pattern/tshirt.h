#pragma once

#include "pattern/garment.h"
#include "skin/body.h"

namespace toile::pattern {

/// The built-in T-shirt. Lengths in metres.
struct TshirtOptions {
    double edge_length = 0.018;  ///< of the triangles [m], 0.006 to 0.05
    double ease = 0.12;          ///< looseness: the garment's chest is this share wider than the body's, 0.02 to 0.6
    double body_length = 0.0;    ///< from the neck point to the hem [m]; 0: to the hip joints and a little more
    double sleeve_length = 0.0;  ///< from the shoulder tip to the cuff [m]; 0: three quarters of the upper arm
};

/// Cuts front, back and two sleeves from measurements taken on the body's neutral pose, meshes and sews them and lays
/// them around the body, outside of it. Four open loops: neckline, hem, two cuffs. The body needs the roles pelvis,
/// neck, both upper and both lower arms, its arms in an A or a T pose. Throws Error for options out of range and for
/// bodies it cannot measure.
///
/// About 0.92 m^2 / edge_length^2 vertices on the built-in body: 1,030 at 0.03, 3,000 at 0.0175. The remark tells what
/// was measured and how the start lies.
Garment make_tshirt(const skin::Body& body, const TshirtOptions& options);

}  // namespace toile::pattern

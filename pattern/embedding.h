#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "skin/body.h"
#include "skin/pose.h"
#include "skin/skinning.h"

namespace toile::pattern {

/// Shrink-wrap of a neutral drape onto the neutral body (method.md, Section 1, step 4).
struct Embedding {
    std::vector<int> triangle;  ///< `[V]` parent triangle of each cloth vertex
    Positions barycentric;      ///< `[V x 3]` weights in it, in [0, 1], sum one
    Positions tangent;          ///< `[V x 3]` unit u axis (pattern direction) in the neutral pose, world frame
    Positions normal;           ///< `[V x 3]` unit normal in the neutral pose, at a right angle to the tangent
    Edges edge;                 ///< `[E x 2]` of the cloth: what frames are smoothed along
    int smoothing = 0;          ///< rounds of averaging with the neighbours
};

/// Nearest points on the body, and neutral frames. The normal is the body's smooth normal at the nearest point; the
/// tangent is the direction the pattern's u axis takes in the drape, averaged over a vertex' triangles by area (at a
/// seam where panels disagree by more than a right angle, the panel that comes first counts). Both are averaged over
/// the cloth within about 4 cm, since neighbours on the cloth can have parents far apart on the body, as below the
/// arms.
///
/// On a garment with sleeves no such field is smooth everywhere: the axes go around the trunk and around each sleeve,
/// and where the two meet there is one point, at the underarm, about which the frame turns once (Poincare-Hopf).
Embedding embed(const ClothMesh& neutral_drape, const skin::Body& body);

/// The shrink-wrapped cloth carried by a posed body, and the frame in which displacements are written.
struct EmbeddedCloth {
    Positions position;                     ///< `[V x 3]` r̃ [m]
    std::vector<Eigen::Quaterniond> frame;  ///< `[V]` turns (Δu, Δv, Δn) into the world; w >= 0
};

/// Positions from the posed body surface. Frames: the neutral ones, turned by the body's blended rotations at the
/// parents, which are averaged over the cloth as the neutral frames are; never by the posed triangles, which fold in
/// creases. So a rigid motion of the whole body moves positions and frames with it and leaves displacements alone.
EmbeddedCloth carry(const Embedding& embedding, const skin::Body& body, const skin::Pose& pose,
                    const Positions& posed_body);

/// The embedded cloth as a data set keeps it: positions and frames rounded to float32.
EmbeddedCloth rounded(const EmbeddedCloth& embedded);

/// (Δu, Δv, Δn) `[V x 3]` [m] with r = r̃ + q·d·q⁻¹. For values that are stored as float32, pass them rounded: then d
/// holds for what is stored.
Positions displacement(const EmbeddedCloth& embedded, const Positions& cloth);
/// r from r̃ and d: the inverse of `displacement`.
Positions displaced(const EmbeddedCloth& embedded, const Positions& displacement);

}  // namespace toile::pattern

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
};

Embedding embed(const ClothMesh& neutral_drape, const skin::Body& body);

/// The shrink-wrapped cloth carried by a posed body, and the frame in which displacements are written.
struct EmbeddedCloth {
    Positions position;                     ///< `[V x 3]` r̃ [m]
    std::vector<Eigen::Quaterniond> frame;  ///< `[V]` turns (Δu, Δv, Δn) into the world; w >= 0
};

/// Positions from the posed body surface; frames from the body's smooth normal and the carried pattern axis. A rigid
/// motion of the whole body moves positions and frames with it.
EmbeddedCloth carry(const Embedding& embedding, const skin::Body& body, const skin::Pose& pose,
                    const Positions& posed_body);

/// (Δu, Δv, Δn) `[V x 3]` [m] with r = r̃ + q·d·q⁻¹.
Positions displacement(const EmbeddedCloth& embedded, const Positions& cloth);
/// r from r̃ and d: the inverse of `displacement`.
Positions displaced(const EmbeddedCloth& embedded, const Positions& displacement);

}  // namespace toile::pattern

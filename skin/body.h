#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cloth/types.h"
#include "skin/role.h"

namespace toile::skin {

struct Joint {
    std::string name;
    int parent = -1;       ///< index of the parent, smaller than its own; -1 for the root
    Eigen::Matrix4d bind;  ///< rigid bind transform B_j, joint to world [m]
};

/// Skin weights by vertex: those of vertex v are entries offset[v] .. offset[v + 1]; each vertex' values sum to one.
struct SkinWeights {
    std::vector<int> offset;    ///< `[Vb + 1]`
    std::vector<int> joint;     ///< `[W]`
    std::vector<double> value;  ///< `[W]`
};

/// A rigged body in its bind pose, which is its neutral pose: metres, y up, facing +z, its left at +x.
struct Body {
    Positions rest_position;  ///< `[Vb x 3]` [m]
    Triangles triangle;       ///< `[Fb x 3]` counter-clockwise outside
    std::vector<Joint> joint;
    SkinWeights weight;
    RoleMap role;

    int vertex_count() const { return static_cast<int>(rest_position.rows()); }
    int joint_count() const { return static_cast<int>(joint.size()); }
};

/// Throws `Error` naming the first defect: no faces, non-finite positions, indices out of range, a joint whose parent
/// does not come before it, a bind transform that is not rigid, weights that are negative or do not sum to one (1e-6).
void check_body(const Body& body, const std::string& where);

}  // namespace toile::skin

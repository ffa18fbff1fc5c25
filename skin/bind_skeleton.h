#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "files/rigged_file.h"

namespace toile::skin {

/// The skeleton of some skinned meshes as they were bound, in the first mesh's own coordinates and unit ("bind space").
struct BindSkeleton {
    struct BindJoint {
        int node;              ///< index into `RiggedFile::node`
        int parent;            ///< index into `joint`, -1 for the root; parents come first
        Eigen::Affine3d bind;  ///< joint to bind space; may scale
    };
    std::vector<BindJoint> joint;
    std::vector<int> joint_of_node;  ///< `[nodes]`, -1 for nodes that are no joints
    /// For each mesh and each of its bones: carries the mesh's stored positions to bind space. All bones of a mesh
    /// agree unless its bind pose is not the first mesh's.
    std::vector<std::vector<Eigen::Affine3d>> placement;
    Eigen::Affine3d scene;  ///< bind space to the scene, by the topmost joint in the file's default pose
    std::vector<std::string> remarks;
};

/// Joints are those of the skins, in the order the skins list them where parents come first, and what lies between them
/// in the node tree. Their bind transforms are the inverses
/// of the offset matrices. A joint that no skin names keeps the bone lengths of the node tree, and is turned to fit the
/// joints around it (weighted least squares; Kabsch 1976). `mesh` lists the indices of the meshes to join, each with
/// bones. Throws Error naming `where` for an offset matrix that is singular or mirrors.
BindSkeleton bind_skeleton(const files::RiggedFile& file, const std::vector<int>& mesh, const std::string& where);

}  // namespace toile::skin

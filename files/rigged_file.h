#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cloth/types.h"

namespace toile::files {

/// A node of the file's scene tree, parents before children.
struct RiggedNode {
    std::string name;
    int parent = -1;
    Eigen::Matrix4d local;  ///< node to parent, as the file's default pose has it: not necessarily the bind pose
};

/// A joint a mesh hangs on.
struct RiggedBone {
    std::string name;
    int node = -1;           ///< index into `RiggedFile::node`
    Eigen::Matrix4d offset;  ///< takes the mesh's stored positions to the joint's frame in the bind pose
};

/// A mesh with its skin. Influences of vertex v are entries influence_offset[v] .. influence_offset[v + 1]; all that
/// the file has are kept, unsorted and not normalised.
struct RiggedMesh {
    std::string name;
    Positions position;      ///< `[N x 3]` as stored: before any node transform, in the file's unit
    Triangles triangle;      ///< `[F x 3]`
    PlanePositions texture;  ///< `[N x 2]`, or empty
    int node = -1;           ///< the node that shows it, index into `RiggedFile::node`
    std::vector<RiggedBone> bone;
    std::vector<int> influence_offset;    ///< `[N + 1]`
    std::vector<int> influence_bone;      ///< `[W]` index into `bone`
    std::vector<double> influence_value;  ///< `[W]`
    double weight_step = 0;               ///< the step of weights stored as integers; 0 for floating point
};

struct RiggedFile {
    std::vector<RiggedMesh> mesh;  ///< those with triangles; `bone` is empty for one without a skin
    std::vector<RiggedNode> node;
    double metres_per_unit = 1;  ///< as the format states it for the scene's root, before the root's own transform
    std::string up = "y";        ///< axis that points up there: "x", "y", "z", "-x", "-y" or "-z"
};

/// Reads glTF (through tinygltf), and FBX, Collada and whatever else with a skeleton assimp reads. Throws Error for a
/// missing, empty, truncated or unreadable file, one without faces or without a skin, positions, weights or matrices
/// that are not finite, indices out of range, and a joint that is no node or, outside glTF, shares its name with
/// another node.
RiggedFile read_rigged_file(const std::string& path);

/// The same for a file whose meshes need no skin.
RiggedFile read_scene(const std::string& path);

}  // namespace toile::files

#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "cloth/types.h"

namespace toile::testing_support {

/// A scene to be written as text glTF, with everything in it that tests want to vary.
struct GltfNode {
    std::string name;
    int parent = -1;
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    Eigen::Vector4d rotation = {0, 0, 0, 1};  ///< x, y, z, w
    double scale = 1;
};

struct GltfSkin {
    std::vector<int> joint;
    std::vector<Eigen::Matrix4d> inverse_bind;  ///< left out of the file where empty
};

enum class WeightFormat { float32, unsigned_byte, unsigned_short };

struct GltfMesh {
    std::string name;
    Positions position;
    PlanePositions texture;  ///< or empty
    Triangles triangle;
    std::vector<std::vector<std::pair<int, double>>> influence;  ///< joint in the skin, weight; empty without a skin
    int skin = -1;
    WeightFormat weight_format = WeightFormat::float32;
};

struct GltfScene {
    std::vector<GltfNode> node;
    std::vector<GltfSkin> skin;
    std::vector<GltfMesh> mesh;  ///< each is shown by a node of its own at the scene's root
};

std::string gltf_text(const GltfScene& scene);

/// Words for the joints of a humanoid in one naming convention; an empty word leaves the joint out.
struct HumanNames {
    std::string pelvis, spine, chest, neck, head;
    /// clavicle, upper arm, lower arm, hand, upper leg, lower leg, foot
    std::vector<std::string> left, right;
};
HumanNames mixamo_names();

/// A person of boxes in a T pose: one closed box along each bone, hung on its joint; 1.7 m, y up, facing +z, feet at
/// y = 0. All 19 roles have a joint.
GltfScene box_person(const HumanNames& names);

/// Moves the bind pose: positions p become m p, inverse bind matrices follow; the node tree stays as it is.
void transform_bind(GltfScene& scene, const Eigen::Matrix4d& m);

/// Writes `bytes` to a file of the running test's own in the temporary folder; returns its path.
std::string write_test_file(const std::string& name, const std::string& bytes);

}  // namespace toile::testing_support

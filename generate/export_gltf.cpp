#include <Eigen/Geometry>

#include "files/gltf_writer.h"
#include "generate/export_formats.h"
#include "generate/look.h"
#include "skin/pose.h"

namespace toile::generate {
namespace {

using Rotations = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Joint j relative to its parent in the bind pose.
Eigen::Isometry3d local_bind(const skin::Body& body, int j) {
    const Eigen::Isometry3d bind(body.joint[j].bind);
    const int parent = body.joint[j].parent;
    return parent < 0 ? bind : Eigen::Isometry3d(body.joint[parent].bind).inverse() * bind;
}

files::GltfSkin gltf_skin(const skin::Body& body) {
    files::GltfSkin skin;
    skin.translation.resize(body.joint_count(), 3);
    for (int j = 0; j < body.joint_count(); ++j) {
        skin.joint_name.push_back(body.joint[j].name);
        skin.joint_parent.push_back(body.joint[j].parent);
        skin.joint_bind.push_back(body.joint[j].bind);
        skin.translation.row(j) = local_bind(body, j).translation().transpose().cast<float>();
    }
    skin.weight_offset = body.weight.offset;
    skin.weight_joint = body.weight.joint;
    skin.weight_value = body.weight.value;
    return skin;
}

/// Of each joint, its rotation relative to its parent in every sample.
std::vector<Rotations> joint_rotations(const ExportSamples& samples) {
    const skin::Body& body = *samples.body();
    std::vector<Rotations> rotation(body.joint.size(), Rotations(samples.count(), 4));
    std::vector<Eigen::Quaterniond> bind;
    for (int j = 0; j < body.joint_count(); ++j) bind.emplace_back(local_bind(body, j).linear());
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("reading poses", k);
        const Positions pose = samples.pose(k);
        for (int j = 0; j < body.joint_count(); ++j) {
            const Eigen::Vector3d turn = pose.row(j);
            const double angle = turn.norm();
            Eigen::Quaterniond q = bind[j];
            if (angle > 0) q = q * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
            rotation[j].row(k) = q.normalized().coeffs().transpose().cast<float>();  // x, y, z, w
        }
    }
    return rotation;
}

std::string target_name(const ExportSamples::Entry& entry) {
    return "pose_" + std::to_string(entry.id);
}

}  // namespace

std::vector<std::string> export_gltf(const ExportSamples& samples, const ExportOptions& options) {
    files::GltfWriter file(options.out, samples.count(), options.rate);
    const ClothMesh& mesh = samples.header().mesh;
    file.begin_morphing_mesh({"cloth", mesh.triangle, mesh.rest_position, cloth_color});
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("writing the cloth", k);
        file.add_target(target_name(samples.entry()[k]), samples.cloth(k));
    }
    if (samples.body()) {
        const skin::Body& body = *samples.body();
        const files::NamedMesh at_rest{"body", body.triangle, body.rest_position, skin_color};
        if (samples.skinned_linearly()) {
            file.add_skinned_mesh(at_rest, gltf_skin(body), joint_rotations(samples));
        } else {  // a glTF skin is linear
            file.begin_morphing_mesh(at_rest);
            for (int k = 0; k < samples.count(); ++k) {
                samples.step("writing the body", k);
                file.add_target(target_name(samples.entry()[k]), samples.body_position(k));
            }
        }
    }
    file.commit();
    return {options.out};
}

}  // namespace toile::generate

#include "files/motion_file.h"

#include <assimp/config.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <functional>

#include "cloth/error.h"
#include "files/bvh_text.h"

namespace toile::files {
namespace {

/// assimp says "<its own file name>:<line> - <what>".
[[noreturn]] void refuse(const std::string& message, const std::string& path) {
    const auto dash = message.find(" - ");
    const auto colon = message.rfind(':', dash);
    if (dash == std::string::npos || colon == std::string::npos) throw Error("not a readable BVH: " + message, path);
    throw Error("not a readable BVH: " + message.substr(dash + 3),
                path + ":" + message.substr(colon + 1, dash - colon - 1));
}

Eigen::Vector3d offset_of(const aiNode& node) {
    return {node.mTransformation.a4, node.mTransformation.b4, node.mTransformation.c4};
}

/// Joints in the order of assimp's animation channels, which is the file's. Nodes between them that no channel drives
/// are the tips of chains.
void collect_joints(const aiNode& node, int parent, const aiAnimation& animation, Motion& motion,
                    std::vector<Eigen::Vector3d>& offset, std::vector<Eigen::Vector3d>& end) {
    const std::size_t next = motion.joint_name.size();
    if (next >= animation.mNumChannels || animation.mChannels[next]->mNodeName != node.mName) {
        if (parent >= 0) end[parent] = offset_of(node);
        return;
    }
    motion.joint_name.emplace_back(node.mName.C_Str());
    motion.joint_parent.push_back(parent);
    offset.push_back(offset_of(node));
    end.emplace_back(Eigen::Vector3d::Zero());
    for (unsigned child = 0; child < node.mNumChildren; ++child)
        collect_joints(*node.mChildren[child], static_cast<int>(next), animation, motion, offset, end);
}

Positions as_rows(const std::vector<Eigen::Vector3d>& point) {
    Positions rows(point.size(), 3);
    for (std::size_t i = 0; i < point.size(); ++i) rows.row(i) = point[i].transpose();
    return rows;
}

Eigen::Quaterniond unit_rotation(const aiQuaternion& key) {
    return Eigen::Quaterniond(key.w, key.x, key.y, key.z).normalized();
}

void collect_frames(const aiAnimation& animation, const std::string& path, Motion& motion) {
    const auto joints = static_cast<std::size_t>(motion.joint_count());
    motion.rotation.resize(static_cast<std::size_t>(motion.frame_count) * joints);
    motion.root_translation.resize(motion.frame_count, 3);
    for (std::size_t j = 0; j < joints; ++j) {
        const aiNodeAnim& channel = *animation.mChannels[j];
        if (static_cast<int>(channel.mNumRotationKeys) != motion.frame_count)
            throw Error("joint '" + motion.joint_name[j] + "' has " + std::to_string(channel.mNumRotationKeys) +
                            " of " + std::to_string(motion.frame_count) + " frames",
                        path);
        for (int frame = 0; frame < motion.frame_count; ++frame) {
            const Eigen::Quaterniond rotation = unit_rotation(channel.mRotationKeys[frame].mValue);
            if (!rotation.coeffs().allFinite())
                throw Error("frame " + std::to_string(frame) + " of joint '" + motion.joint_name[j] +
                                "' holds a value that is not a number",
                            path);
            motion.rotation[frame * joints + j] = rotation;
        }
    }
    const aiNodeAnim& root = *animation.mChannels[0];
    for (int frame = 0; frame < motion.frame_count; ++frame) {
        const auto& key = root.mPositionKeys[root.mNumPositionKeys > 1 ? frame : 0].mValue;
        motion.root_translation.row(frame) << key.x, key.y, key.z;
        if (!motion.root_translation.row(frame).allFinite())
            throw Error("frame " + std::to_string(frame) + " of the root holds a position that is not a number", path);
    }
}

}  // namespace

Positions rest_positions(const Motion& motion) {
    Positions position = motion.rest_offset;
    if (motion.joint_count() > 0) position.row(0).setZero();
    for (int j = 1; j < motion.joint_count(); ++j) position.row(j) += position.row(motion.joint_parent[j]);
    return position;
}

Motion read_motion(const std::string& path) {
    const BvhText bvh = read_bvh_text(path);
    Assimp::Importer importer;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const aiScene* scene = importer.ReadFileFromMemory(bvh.text.data(), bvh.text.size(), 0, "bvh");
    if (!scene || !scene->mRootNode || scene->mNumAnimations != 1) refuse(importer.GetErrorString(), path);
    const aiAnimation& animation = *scene->mAnimations[0];

    Motion motion;
    std::vector<Eigen::Vector3d> offset, end;
    collect_joints(*scene->mRootNode, -1, animation, motion, offset, end);
    if (motion.joint_count() != bvh.joint_count)
        throw Error("the hierarchy has " + std::to_string(bvh.joint_count) + " joints, of which " +
                        std::to_string(motion.joint_count()) + " could be read",
                    path);
    motion.rest_offset = as_rows(offset);
    motion.end_offset = as_rows(end);
    if (!motion.rest_offset.allFinite() || !motion.end_offset.allFinite())
        throw Error("an OFFSET of the hierarchy is not a number", path);
    motion.frame_time = bvh.frame_time;
    motion.frame_count = bvh.frame_count;
    collect_frames(animation, path, motion);
    return motion;
}

}  // namespace toile::files

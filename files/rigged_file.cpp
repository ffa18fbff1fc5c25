#include "files/rigged_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "cloth/error.h"
#include "files/gltf_reader.h"
#include "files/mesh_scene.h"

namespace toile::files {
namespace {

void add_nodes(const aiNode& node, int parent, RiggedFile& file) {
    const int index = static_cast<int>(file.node.size());
    file.node.push_back({node.mName.C_Str(), parent, matrix_of(node.mTransformation)});
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_nodes(*node.mChildren[i], index, file);
}

/// Node index by name; -2 for a name that several nodes have.
std::map<std::string, int> nodes_by_name(const RiggedFile& file) {
    std::map<std::string, int> by_name;
    for (size_t i = 0; i < file.node.size(); ++i) {
        const auto [entry, fresh] = by_name.try_emplace(file.node[i].name, static_cast<int>(i));
        if (!fresh) entry->second = -2;
    }
    return by_name;
}

RiggedBone bone_of(const aiBone& bone, const std::map<std::string, int>& by_name, const std::string& path) {
    RiggedBone out{bone.mName.C_Str(), -1, matrix_of(bone.mOffsetMatrix)};
    const auto node = by_name.find(out.name);
    if (node == by_name.end()) throw Error("the skin refers to a joint '" + out.name + "' that is no node", path);
    if (node->second == -2)
        throw Error("several nodes have the name of joint '" + out.name + "'", path, "give each node its own name");
    out.node = node->second;
    return out;
}

/// The influences of all vertices, vertex by vertex, in the order of the bones.
void add_influences(const aiMesh& mesh, const std::string& path, RiggedMesh& out) {
    std::vector<int> count(mesh.mNumVertices, 0);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        for (unsigned i = 0; i < mesh.mBones[b]->mNumWeights; ++i) {
            const aiVertexWeight& weight = mesh.mBones[b]->mWeights[i];
            if (weight.mVertexId >= mesh.mNumVertices)
                throw Error("joint '" + out.bone[b].name + "' moves vertex " + std::to_string(weight.mVertexId) +
                                " of " + std::to_string(mesh.mNumVertices),
                            path);
            if (!std::isfinite(weight.mWeight))
                throw Error("the weight of vertex " + std::to_string(weight.mVertexId) + " for joint '" +
                                out.bone[b].name + "' is not finite",
                            path);
            ++count[weight.mVertexId];
        }
    }
    out.influence_offset.assign(1, 0);
    for (const int n : count) out.influence_offset.push_back(out.influence_offset.back() + n);
    out.influence_bone.resize(out.influence_offset.back());
    out.influence_value.resize(out.influence_offset.back());
    std::vector<int> next(out.influence_offset.begin(), out.influence_offset.end() - 1);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        for (unsigned i = 0; i < mesh.mBones[b]->mNumWeights; ++i) {
            const aiVertexWeight& weight = mesh.mBones[b]->mWeights[i];
            const int slot = next[weight.mVertexId]++;
            out.influence_bone[slot] = static_cast<int>(b);
            out.influence_value[slot] = weight.mWeight;
        }
    }
}

RiggedMesh mesh_of(const aiMesh& mesh, const std::map<std::string, int>& by_name, const std::string& path) {
    check_scene_mesh(mesh, path);
    RiggedMesh out;
    out.name = mesh.mName.C_Str();
    out.position.resize(mesh.mNumVertices, 3);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
        out.position.row(v) << mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z;
    std::vector<std::array<int, 3>> triangle;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices != 3) continue;  // points and lines
        triangle.push_back({static_cast<int>(face.mIndices[0]), static_cast<int>(face.mIndices[1]),
                            static_cast<int>(face.mIndices[2])});
    }
    out.triangle.resize(static_cast<long>(triangle.size()), 3);
    for (size_t f = 0; f < triangle.size(); ++f)
        out.triangle.row(static_cast<long>(f)) << triangle[f][0], triangle[f][1], triangle[f][2];
    if (mesh.HasTextureCoords(0)) {
        out.texture.resize(mesh.mNumVertices, 2);
        for (unsigned v = 0; v < mesh.mNumVertices; ++v)
            out.texture.row(v) << mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y;
    }
    for (unsigned b = 0; b < mesh.mNumBones; ++b) out.bone.push_back(bone_of(*mesh.mBones[b], by_name, path));
    add_influences(mesh, path, out);
    return out;
}

double number(const aiMetadata& data, const char* key, double otherwise) {
    double wide = 0;
    float narrow = 0;
    int32_t whole = 0;
    if (data.Get(key, wide)) return wide;
    if (data.Get(key, narrow)) return narrow;
    if (data.Get(key, whole)) return whole;
    return otherwise;
}

/// FBX states its unit (in centimetres) and axes apart from the scene tree; assimp leaves them there. The other
/// importers fold what the format says into the root node, or there is nothing to say.
void read_conventions(const aiScene& scene, RiggedFile& file) {
    if (!scene.mMetaData || !scene.mMetaData->HasKey("UnitScaleFactor")) return;
    const double unit = number(*scene.mMetaData, "UnitScaleFactor", 1) / 100;
    if (std::isfinite(unit) && unit > 0) file.metres_per_unit = unit;
    const int axis = static_cast<int>(number(*scene.mMetaData, "UpAxis", 1));
    const double sign = number(*scene.mMetaData, "UpAxisSign", 1);
    if (axis >= 0 && axis < 3) file.up = std::string(sign < 0 ? "-" : "") + "xyz"[axis];
}

/// The meshes each node shows; nodes are counted in the order `add_nodes` lists them.
void add_meshes(const aiScene& scene, const aiNode& node, int& index, const std::map<std::string, int>& by_name,
                const std::string& path, RiggedFile& file) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        RiggedMesh mesh = mesh_of(*scene.mMeshes[node.mMeshes[i]], by_name, path);
        mesh.node = index;
        if (mesh.triangle.rows() > 0) file.mesh.push_back(std::move(mesh));
    }
    ++index;
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_meshes(scene, *node.mChildren[i], index, by_name, path, file);
}

RiggedFile read_with_assimp(const std::string& path) {
    Assimp::Importer importer;
    // Pivots would turn each FBX joint into a chain of nodes.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    const aiScene* scene = open_scene(importer, path, aiProcess_Triangulate);
    RiggedFile file;
    add_nodes(*scene->mRootNode, -1, file);
    const auto by_name = nodes_by_name(file);
    int index = 0;
    add_meshes(*scene, *scene->mRootNode, index, by_name, path, file);
    read_conventions(*scene, file);
    return file;
}

}  // namespace

RiggedFile read_scene(const std::string& path) {
    RiggedFile file = is_gltf(path) ? read_gltf(path) : read_with_assimp(path);
    for (const RiggedNode& node : file.node)
        if (!node.local.allFinite()) throw Error("the transform of node '" + node.name + "' is not finite", path);
    if (file.mesh.empty()) throw Error("the file has no faces", path);
    return file;
}

RiggedFile read_rigged_file(const std::string& path) {
    RiggedFile file = read_scene(path);
    bool skinned = false;
    for (const RiggedMesh& mesh : file.mesh) {
        skinned = skinned || !mesh.bone.empty();
        for (const RiggedBone& bone : mesh.bone)
            if (!bone.offset.allFinite())
                throw Error("the bind matrix of joint '" + bone.name + "' is not finite", path);
    }
    if (!skinned) throw Error("no mesh of the file has a skin", path, "export the body with its armature and weights");
    return file;
}

}  // namespace toile::files

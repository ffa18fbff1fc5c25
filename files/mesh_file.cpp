#include "files/mesh_file.h"

#include <assimp/postprocess.h>

#include <array>
#include <cstring>
#include <map>
#include <unordered_map>

#include "cloth/error.h"
#include "files/mesh_scene.h"

namespace toile::files {
namespace {

/// What makes a vertex: its position and texture coordinates, bit by bit.
using VertexKey = std::array<double, 5>;
struct VertexHash {
    size_t operator()(const VertexKey& key) const {
        size_t hash = 0;
        for (const double value : key) hash = hash * 1099511628211u ^ std::hash<double>()(value);
        return hash;
    }
};

/// Gathers the triangles of all meshes; an importer that repeats every corner (OBJ) is undone here.
struct MeshGatherer {
    const std::string& path;
    const aiScene& scene;
    std::unordered_map<VertexKey, int, VertexHash> index;
    std::vector<VertexKey> vertex;
    std::vector<std::array<int, 3>> triangle;
    MeshData data;
    bool textured = true;

    int vertex_of(const aiMesh& mesh, unsigned v, const Eigen::Matrix4d& transform) {
        const aiVector3D& p = mesh.mVertices[v];
        const Eigen::Vector4d moved = transform * Eigen::Vector4d(p.x, p.y, p.z, 1);
        // Adding zero turns -0 into 0, which hash alike only then.
        VertexKey key = {moved.x() + 0.0, moved.y() + 0.0, moved.z() + 0.0, 0, 0};
        if (mesh.HasTextureCoords(0)) {
            key[3] = mesh.mTextureCoords[0][v].x + 0.0;
            key[4] = mesh.mTextureCoords[0][v].y + 0.0;
        }
        const auto [entry, fresh] = index.try_emplace(key, static_cast<int>(vertex.size()));
        if (fresh) vertex.push_back(key);
        return entry->second;
    }

    void add_mesh(const aiMesh& mesh, const Eigen::Matrix4d& transform) {
        check_scene_mesh(mesh, path);
        const int part = static_cast<int>(data.part_name.size());
        data.part_name.emplace_back(mesh.mName.C_Str());
        textured = textured && mesh.HasTextureCoords(0);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;  // points and lines
            triangle.push_back({vertex_of(mesh, face.mIndices[0], transform),
                                vertex_of(mesh, face.mIndices[1], transform),
                                vertex_of(mesh, face.mIndices[2], transform)});
            data.part.push_back(part);
        }
    }

    void add_node(const aiNode& node, const Eigen::Matrix4d& parent) {
        const Eigen::Matrix4d transform = parent * matrix_of(node.mTransformation);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene.mMeshes[node.mMeshes[i]], transform);
        for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(*node.mChildren[i], transform);
    }
};

}  // namespace

MeshData read_mesh(const std::string& path) {
    Assimp::Importer importer;
    const aiScene* scene = open_scene(importer, path, aiProcess_Triangulate);
    MeshGatherer gatherer{path, *scene, {}, {}, {}, {}};
    gatherer.add_node(*scene->mRootNode, Eigen::Matrix4d::Identity());
    if (gatherer.triangle.empty()) throw Error("the mesh has no faces", path);
    MeshData data = std::move(gatherer.data);
    const size_t count = gatherer.vertex.size();
    data.position.resize(count, 3);
    if (gatherer.textured) data.texture.resize(count, 2);
    for (size_t v = 0; v < count; ++v) {
        const VertexKey& key = gatherer.vertex[v];
        data.position.row(v) << key[0], key[1], key[2];
        if (gatherer.textured) data.texture.row(v) << key[3], key[4];
    }
    data.triangle.resize(gatherer.triangle.size(), 3);
    for (size_t f = 0; f < gatherer.triangle.size(); ++f)
        data.triangle.row(f) << gatherer.triangle[f][0], gatherer.triangle[f][1], gatherer.triangle[f][2];
    return data;
}

void write_mesh(const std::string& path, const Triangles& triangle, const Positions& position) {
    write_meshes(path, {NamedMesh{"mesh", triangle, position}});
}

}  // namespace toile::files

#include "files/mesh_file.h"

#include <Eigen/Geometry>
#include <array>
#include <unordered_map>

#include "cloth/error.h"
#include "files/mesh_scene.h"
#include "files/obj_text.h"
#include "files/ply_header.h"
#include "files/rigged_file.h"

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

/// Gathers the triangles of all parts; an importer that repeats every corner (OBJ) is undone here.
struct MeshGatherer {
    std::unordered_map<VertexKey, int, VertexHash> index;
    std::vector<VertexKey> vertex;
    std::vector<std::array<int, 3>> triangle;
    MeshData data;
    bool textured = true;

    int joined(const Eigen::Vector3d& position, double u, double v) {
        // Adding zero turns -0 into 0, which hash alike only then.
        const VertexKey key = {position.x() + 0.0, position.y() + 0.0, position.z() + 0.0, u + 0.0, v + 0.0};
        const auto [entry, fresh] = index.try_emplace(key, static_cast<int>(vertex.size()));
        if (fresh) vertex.push_back(key);
        return entry->second;
    }

    void add_mesh(const RiggedMesh& mesh, const Eigen::Affine3d& transform) {
        const int part = static_cast<int>(data.part_name.size());
        data.part_name.push_back(mesh.name);
        const bool has_texture = mesh.texture.rows() > 0;
        textured = textured && has_texture;
        std::vector<int> index_of(static_cast<size_t>(mesh.position.rows()));
        for (int v = 0; v < mesh.position.rows(); ++v)
            index_of[v] = joined(transform * mesh.position.row(v).transpose(), has_texture ? mesh.texture(v, 0) : 0,
                                 has_texture ? mesh.texture(v, 1) : 0);
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            std::array<int, 3> corners;
            for (int corner = 0; corner < 3; ++corner) corners[corner] = index_of[mesh.triangle(f, corner)];
            triangle.push_back(corners);
            data.part.push_back(part);
        }
    }

    MeshData finish() {
        const long count = static_cast<long>(vertex.size());
        data.position.resize(count, 3);
        if (textured) data.texture.resize(count, 2);
        for (long v = 0; v < count; ++v) {
            const VertexKey& key = vertex[v];
            data.position.row(v) << key[0], key[1], key[2];
            if (textured) data.texture.row(v) << key[3], key[4];
        }
        data.triangle.resize(static_cast<long>(triangle.size()), 3);
        for (size_t f = 0; f < triangle.size(); ++f)
            data.triangle.row(static_cast<long>(f)) << triangle[f][0], triangle[f][1], triangle[f][2];
        return std::move(data);
    }
};

}  // namespace

MeshData read_mesh(const std::string& path) {
    check_readable(path);
    if (has_extension(path, ".obj")) check_obj_text(path);
    if (has_extension(path, ".ply")) check_ply_header(path);
    const RiggedFile file = read_scene(path);
    std::vector<Eigen::Affine3d> world;
    for (const RiggedNode& node : file.node) {
        const Eigen::Affine3d local(node.local);
        world.push_back(node.parent < 0 ? local : world[node.parent] * local);
    }
    MeshGatherer gatherer;
    for (const RiggedMesh& mesh : file.mesh) {
        // A skinned mesh is placed by its joints; its stored positions are those of the bind pose.
        const bool placed = mesh.node >= 0 && mesh.bone.empty();
        gatherer.add_mesh(mesh, placed ? world[mesh.node] : Eigen::Affine3d::Identity());
    }
    return gatherer.finish();
}

void write_mesh(const std::string& path, const Triangles& triangle, const Positions& position) {
    write_meshes(path, {NamedMesh{"mesh", triangle, position}});
}

}  // namespace toile::files

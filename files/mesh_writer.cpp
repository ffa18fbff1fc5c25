// assimp's own exporters are not used: they merge and reorder vertices, and write float32 where float64 is asked for.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "cloth/error.h"
#include "files/gltf_writer.h"
#include "files/mesh_file.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

void check_mesh(const NamedMesh& mesh, const std::string& path) {
    for (int v = 0; v < mesh.position.rows(); ++v)
        if (!mesh.position.row(v).allFinite())
            throw Error("vertex " + std::to_string(v) + " of mesh '" + mesh.name + "' is not finite", path);
    if (mesh.triangle.size() > 0 && (mesh.triangle.minCoeff() < 0 || mesh.triangle.maxCoeff() >= mesh.position.rows()))
        throw Error("a triangle of mesh '" + mesh.name + "' refers to a vertex that is not there", path);
    if (mesh.vertex_color.size() > 0 &&
        (mesh.vertex_color.rows() != mesh.position.rows() || !mesh.vertex_color.allFinite()))
        throw Error("the colours of mesh '" + mesh.name + "' do not go with its vertices", path);
    if (mesh.texture.size() == 0) return;
    if (!mesh.texture.allFinite() || mesh.texture_triangle.rows() != mesh.triangle.rows() ||
        mesh.texture_triangle.minCoeff() < 0 || mesh.texture_triangle.maxCoeff() >= mesh.texture.rows())
        throw Error("the texture coordinates of mesh '" + mesh.name + "' do not go with its triangles", path);
}

std::string one_word(std::string name) {
    for (char& c : name)
        if (static_cast<unsigned char>(c) <= ' ') c = '_';
    return name.empty() ? "mesh" : name;
}

/// "7" or, with a texture, "7/9"
std::string obj_corner(const NamedMesh& mesh, int f, int corner, int first, int first_texture) {
    std::string text = " " + std::to_string(mesh.triangle(f, corner) + first);
    if (mesh.texture.size() > 0) text += "/" + std::to_string(mesh.texture_triangle(f, corner) + first_texture);
    return text;
}

std::string obj_text(const std::vector<NamedMesh>& meshes) {
    std::string text;
    char line[160];
    int first = 1, first_texture = 1;
    for (const NamedMesh& mesh : meshes) {
        text += "o " + one_word(mesh.name) + "\n";
        for (int v = 0; v < mesh.position.rows(); ++v) {
            std::snprintf(line, sizeof line, "v %.12f %.12f %.12f\n", mesh.position(v, 0), mesh.position(v, 1),
                          mesh.position(v, 2));
            text += line;
        }
        for (int p = 0; p < mesh.texture.rows(); ++p) {
            std::snprintf(line, sizeof line, "vt %.9f %.9f\n", mesh.texture(p, 0), mesh.texture(p, 1));
            text += line;
        }
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            text += 'f';
            for (int corner = 0; corner < 3; ++corner) text += obj_corner(mesh, f, corner, first, first_texture);
            text += '\n';
        }
        first += static_cast<int>(mesh.position.rows());
        first_texture += static_cast<int>(mesh.texture.rows());
    }
    return text;
}

template <typename T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_header(const std::vector<NamedMesh>& meshes, bool textured, bool coloured) {
    long vertices = 0, triangles = 0;
    for (const NamedMesh& mesh : meshes) {
        vertices += mesh.position.rows();
        triangles += mesh.triangle.rows();
    }
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
           "\nproperty double x\nproperty double y\nproperty double z\n" +
           (coloured ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "") + "element face " +
           std::to_string(triangles) + "\nproperty list uchar int vertex_indices\n" +
           (textured ? "property list uchar float texcoord\n" : "") + "end_header\n";
}

void append_texture(std::string& bytes, const NamedMesh& mesh, int f) {
    const bool textured = mesh.texture.size() > 0;
    append(bytes, static_cast<uint8_t>(textured ? 6 : 0));
    for (int corner = 0; textured && corner < 3; ++corner)
        for (int axis = 0; axis < 2; ++axis)
            append(bytes, static_cast<float>(mesh.texture(mesh.texture_triangle(f, corner), axis)));
}

/// Three bytes; white without a colour.
void append_color(std::string& bytes, const NamedMesh& mesh, Eigen::Index v) {
    for (int k = 0; k < 3; ++k) {
        const double color = mesh.vertex_color.rows() > 0 ? mesh.vertex_color(v, k) : 1;
        append(bytes, static_cast<uint8_t>(std::lround(255 * std::clamp(color, 0.0, 1.0))));
    }
}

std::string ply_bytes(const std::vector<NamedMesh>& meshes) {
    const bool textured =
        std::any_of(meshes.begin(), meshes.end(), [](const NamedMesh& mesh) { return mesh.texture.size() > 0; });
    const bool coloured =
        std::any_of(meshes.begin(), meshes.end(), [](const NamedMesh& mesh) { return mesh.vertex_color.rows() > 0; });
    std::string bytes = ply_header(meshes, textured, coloured);
    for (const NamedMesh& mesh : meshes) {
        for (Eigen::Index v = 0; v < mesh.position.rows(); ++v) {
            bytes.append(reinterpret_cast<const char*>(mesh.position.row(v).data()), 3 * sizeof(double));
            if (coloured) append_color(bytes, mesh, v);
        }
    }
    int32_t first = 0;
    for (const NamedMesh& mesh : meshes) {
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            append(bytes, uint8_t{3});
            for (int corner = 0; corner < 3; ++corner) append(bytes, int32_t{mesh.triangle(f, corner) + first});
            if (textured) append_texture(bytes, mesh, f);
        }
        first += static_cast<int32_t>(mesh.position.rows());
    }
    return bytes;
}

}  // namespace

void write_meshes(const std::string& path, const std::vector<NamedMesh>& meshes) {
    for (const NamedMesh& mesh : meshes) check_mesh(mesh, path);
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension == ".glb") {
        GltfWriter file(path);
        for (const NamedMesh& mesh : meshes) file.add_mesh(mesh);
        return file.commit();
    }
    std::string bytes;
    if (extension == ".obj")
        bytes = obj_text(meshes);
    else if (extension == ".ply")
        bytes = ply_bytes(meshes);
    else
        throw Error("meshes are not written as '" + extension + "'", path, "end the name in .obj, .ply or .glb");
    NewFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

}  // namespace toile::files

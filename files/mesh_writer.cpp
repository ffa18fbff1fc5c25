// assimp's own exporters are not used: they merge and reorder vertices, and write float32 where float64 is asked for.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cloth/error.h"
#include "cloth/topology.h"
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
}

std::string one_word(std::string name) {
    for (char& c : name)
        if (static_cast<unsigned char>(c) <= ' ') c = '_';
    return name.empty() ? "mesh" : name;
}

std::string obj_text(const std::vector<NamedMesh>& meshes) {
    std::string text;
    char line[160];
    int first = 1;
    for (const NamedMesh& mesh : meshes) {
        text += "o " + one_word(mesh.name) + "\n";
        for (int v = 0; v < mesh.position.rows(); ++v) {
            std::snprintf(line, sizeof line, "v %.12f %.12f %.12f\n", mesh.position(v, 0), mesh.position(v, 1),
                          mesh.position(v, 2));
            text += line;
        }
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            std::snprintf(line, sizeof line, "f %d %d %d\n", mesh.triangle(f, 0) + first, mesh.triangle(f, 1) + first,
                          mesh.triangle(f, 2) + first);
            text += line;
        }
        first += static_cast<int>(mesh.position.rows());
    }
    return text;
}

template <typename T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_bytes(const std::vector<NamedMesh>& meshes) {
    long vertices = 0, triangles = 0;
    for (const NamedMesh& mesh : meshes) {
        vertices += mesh.position.rows();
        triangles += mesh.triangle.rows();
    }
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
                        "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                        std::to_string(triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const NamedMesh& mesh : meshes)
        bytes.append(reinterpret_cast<const char*>(mesh.position.data()), sizeof(double) * mesh.position.size());
    int32_t first = 0;
    for (const NamedMesh& mesh : meshes) {
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            append(bytes, uint8_t{3});
            for (int corner = 0; corner < 3; ++corner) append(bytes, int32_t{mesh.triangle(f, corner) + first});
        }
        first += static_cast<int32_t>(mesh.position.rows());
    }
    return bytes;
}

std::string json_text(const std::string& text) {
    std::string quoted = "\"";
    char code[8];
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        if (static_cast<unsigned char>(c) < 0x20) {
            std::snprintf(code, sizeof code, "\\u%04x", c);
            quoted += code;
        } else {
            quoted += c;
        }
    }
    return quoted + "\"";
}

std::string vector_text(const Eigen::Vector3f& v) {
    char text[80];
    std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g", v[0], v[1], v[2]);
    return text;
}

/// The lists of a glTF 2.0 document with its binary buffer, one mesh after the other.
struct GlbDocument {
    std::string buffer, views, accessors, meshes, materials, nodes, scene;
    int count = 0;

    static void list(std::string& into, const std::string& item) { into += (into.empty() ? "" : ",") + item; }

    void add_accessor(size_t start, long rows, int target, const std::string& type) {
        list(views, "{\"buffer\":0,\"byteOffset\":" + std::to_string(start) + ",\"byteLength\":" +
                        std::to_string(buffer.size() - start) + ",\"target\":" + std::to_string(target) + "}");
        list(accessors,
             "{\"bufferView\":" + std::to_string(count++) + ",\"count\":" + std::to_string(rows) + type + "}");
    }

    void add_vectors(const Positions& rows, bool bounds) {
        const size_t start = buffer.size();
        for (int v = 0; v < rows.rows(); ++v)
            for (int axis = 0; axis < 3; ++axis) append(buffer, static_cast<float>(rows(v, axis)));
        std::string type = ",\"componentType\":5126,\"type\":\"VEC3\"";
        if (bounds)
            type += ",\"min\":[" + vector_text(rows.colwise().minCoeff().transpose().cast<float>()) + "],\"max\":[" +
                    vector_text(rows.colwise().maxCoeff().transpose().cast<float>()) + "]";
        add_accessor(start, rows.rows(), 34962, type);
    }

    void add(const NamedMesh& mesh, int index) {
        if (mesh.position.rows() == 0 || mesh.triangle.rows() == 0) return;  // glTF knows no empty accessor
        const std::string first = std::to_string(count), second = std::to_string(count + 1),
                          third = std::to_string(count + 2);
        add_vectors(mesh.position, true);
        Positions normal = vertex_normals(mesh.triangle, mesh.position);
        for (int v = 0; v < normal.rows(); ++v)
            if (normal.row(v).squaredNorm() < 0.5) normal.row(v) << 0, 1, 0;
        add_vectors(normal, false);
        const size_t start = buffer.size();
        for (int f = 0; f < mesh.triangle.rows(); ++f)
            for (int corner = 0; corner < 3; ++corner) append(buffer, static_cast<uint32_t>(mesh.triangle(f, corner)));
        add_accessor(start, mesh.triangle.size(), 34963, ",\"componentType\":5125,\"type\":\"SCALAR\"");
        const std::string number = std::to_string(index);
        list(meshes, "{\"name\":" + json_text(mesh.name) + ",\"primitives\":[{\"attributes\":{\"POSITION\":" + first +
                         ",\"NORMAL\":" + second + "},\"indices\":" + third + ",\"material\":" + number + "}]}");
        list(materials, "{\"name\":" + json_text(mesh.name) +
                            ",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":[" +
                            vector_text(mesh.color) + ",1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}");
        list(nodes, "{\"name\":" + json_text(mesh.name) + ",\"mesh\":" + number + "}");
        list(scene, number);
    }

    std::string bytes() const {
        std::string json =
            "{\"asset\":{\"version\":\"2.0\",\"generator\":\"toile\"},\"scene\":0,\"scenes\":[{\"nodes\":[" + scene +
            "]}],\"nodes\":[" + nodes + "],\"meshes\":[" + meshes + "],\"materials\":[" + materials +
            "],\"accessors\":[" + accessors + "],\"bufferViews\":[" + views +
            "],\"buffers\":[{\"byteLength\":" + std::to_string(buffer.size()) + "}]}";
        while (json.size() % 4) json += ' ';
        std::string out = "glTF";
        append(out, uint32_t{2});
        append(out, static_cast<uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
        append(out, static_cast<uint32_t>(json.size()));
        out += "JSON" + json;
        append(out, static_cast<uint32_t>(buffer.size()));
        out.append("BIN\0", 4);
        return out + buffer;
    }
};

std::string glb_bytes(const std::vector<NamedMesh>& meshes, const std::string& path) {
    GlbDocument document;
    int index = 0;
    for (const NamedMesh& mesh : meshes) {
        document.add(mesh, index);
        index += mesh.position.rows() > 0 && mesh.triangle.rows() > 0;
    }
    if (index == 0) throw Error("there are no triangles to write", path);
    return document.bytes();
}

}  // namespace

void write_meshes(const std::string& path, const std::vector<NamedMesh>& meshes) {
    for (const NamedMesh& mesh : meshes) check_mesh(mesh, path);
    const std::string extension = std::filesystem::path(path).extension().string();
    std::string bytes;
    if (extension == ".obj")
        bytes = obj_text(meshes);
    else if (extension == ".ply")
        bytes = ply_bytes(meshes);
    else if (extension == ".glb")
        bytes = glb_bytes(meshes, path);
    else
        throw Error("meshes are not written as '" + extension + "'", path, "end the name in .obj, .ply or .glb");
    NewFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

}  // namespace toile::files

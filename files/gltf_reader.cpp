#include "files/gltf_reader.h"

#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cloth/error.h"
#include "files/gltf_accessor.h"
#include "files/mesh_scene.h"
#include "files/trial_run.h"

namespace toile::files {
namespace {

constexpr Eigen::Index most_vertices = 10'000'000;

bool skip_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

/// An index as the file has it, which may be any number.
std::string whole(double value) {
    return std::abs(value) < 1e15 ? std::to_string(std::llround(value)) : std::to_string(value);
}

/// Returns what is wrong, or nothing.
std::string parse(const std::string& bytes, const std::string& path, tinygltf::Model& model) {
    const unsigned size = static_cast<unsigned>(bytes.size());
    const std::string folder = std::filesystem::path(path).parent_path().string();
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(skip_image, nullptr);
    std::string reason, warning;
    bool done = false;
    try {
        if (bytes.starts_with("glTF"))
            done = loader.LoadBinaryFromMemory(&model, &reason, &warning,
                                               reinterpret_cast<const unsigned char*>(bytes.data()), size, folder);
        else
            done = loader.LoadASCIIFromString(&model, &reason, &warning, bytes.data(), size, folder);
    } catch (const std::exception& error) {
        reason = error.what();
    }
    return done ? "" : reason.empty() ? "damaged" : reason;
}

tinygltf::Model load_model(const std::string& path) {
    check_readable(path);
    std::ifstream stream(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (bytes.size() > std::numeric_limits<unsigned>::max()) throw Error("the file is too large", path);
    if (!bytes.starts_with("glTF") && bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf") != bytes.find('{'))
        throw Error("the file is no glTF, text or binary", path);
    // Lists nested thousands deep make the parser run out of stack.
    const std::string complaint = trial_run(path, 5 + 2 * static_cast<int>(bytes.size() >> 20), [&] {
        tinygltf::Model model;
        return parse(bytes, path, model);
    });
    if (!complaint.empty()) throw Error("cannot read the glTF file: " + one_line(complaint), path);
    tinygltf::Model model;
    parse(bytes, path, model);
    for (const std::string& extension : model.extensionsRequired)
        if (extension.find("draco") != std::string::npos || extension.find("meshopt") != std::string::npos)
            throw Error("the file is compressed with " + extension + ", which is not read", path,
                        "export it without mesh compression");
    return model;
}

Eigen::Matrix4d local_transform(const tinygltf::Node& node) {
    Eigen::Affine3d local = Eigen::Affine3d::Identity();
    if (node.matrix.size() == 16) return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
    if (node.translation.size() == 3) local.translation() = Eigen::Map<const Eigen::Vector3d>(node.translation.data());
    if (node.rotation.size() == 4)
        local.linear() = Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])
                             .normalized()
                             .toRotationMatrix();
    if (node.scale.size() == 3) local.linear() *= Eigen::Map<const Eigen::Vector3d>(node.scale.data()).asDiagonal();
    return local.matrix();
}

/// Parent of each node; throws if the nodes are no forest.
std::vector<int> node_parents(const tinygltf::Model& model, const std::string& path) {
    std::vector<int> parent(model.nodes.size(), -1);
    for (size_t n = 0; n < model.nodes.size(); ++n) {
        for (const int child : model.nodes[n].children) {
            if (child < 0 || static_cast<size_t>(child) >= model.nodes.size())
                throw Error("node " + std::to_string(n) + " has a child that is not there", path);
            if (parent[child] >= 0) throw Error("node " + std::to_string(child) + " has two parents", path);
            parent[child] = static_cast<int>(n);
        }
    }
    return parent;
}

/// Fills `file.node` with parents first; returns the new index of each of the file's nodes.
std::vector<int> add_nodes(const tinygltf::Model& model, const std::string& path, RiggedFile& file) {
    const std::vector<int> parent = node_parents(model, path);
    std::vector<int> index(model.nodes.size(), -1), waiting;
    for (size_t n = model.nodes.size(); n-- > 0;)
        if (parent[n] < 0) waiting.push_back(static_cast<int>(n));
    while (!waiting.empty()) {
        const int n = waiting.back();
        waiting.pop_back();
        const tinygltf::Node& node = model.nodes[n];
        index[n] = static_cast<int>(file.node.size());
        file.node.push_back({node.name.empty() ? "node_" + std::to_string(n) : node.name,
                             parent[n] < 0 ? -1 : index[parent[n]], local_transform(node)});
        waiting.insert(waiting.end(), node.children.rbegin(), node.children.rend());
    }
    if (file.node.size() != model.nodes.size()) throw Error("the nodes of the scene run in a circle", path);
    return index;
}

/// What reading one primitive needs at hand.
struct PrimitiveReader {
    const tinygltf::Model& model;
    const std::string& path;
    const std::vector<int>& node_index;

    Positions vectors(int accessor) const {
        const AccessorData data = read_accessor(model, accessor, 3, path);
        return Eigen::Map<const Positions>(data.value.data(), data.count, 3);
    }

    std::vector<int> corner_indices(const tinygltf::Primitive& primitive, int vertices) const {
        std::vector<int> corner;
        if (primitive.indices < 0) {
            for (int v = 0; v < vertices; ++v) corner.push_back(v);
            return corner;
        }
        const AccessorData data = read_accessor(model, primitive.indices, 1, path);
        for (const double value : data.value) {
            if (!(value >= 0 && value < vertices))
                throw Error("a face refers to vertex " + whole(value) + " of " + std::to_string(vertices), path);
            corner.push_back(static_cast<int>(value));
        }
        return corner;
    }

    Triangles triangles(const tinygltf::Primitive& primitive, int vertices) const {
        const std::vector<int> corner = corner_indices(primitive, vertices);
        const int count = static_cast<int>(corner.size());
        std::vector<std::array<int, 3>> face;
        if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            for (int i = 0; i + 2 < count; ++i)
                face.push_back({corner[i], corner[i + 1 + i % 2], corner[i + 2 - i % 2]});
        else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN)
            for (int i = 1; i + 1 < count; ++i) face.push_back({corner[0], corner[i], corner[i + 1]});
        else if (primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode < 0)
            for (int i = 0; i + 2 < count; i += 3) face.push_back({corner[i], corner[i + 1], corner[i + 2]});
        Triangles triangle(static_cast<long>(face.size()), 3);
        for (size_t f = 0; f < face.size(); ++f)
            triangle.row(static_cast<long>(f)) << face[f][0], face[f][1], face[f][2];
        return triangle;
    }

    std::vector<RiggedBone> bones(int skin_index) const {
        if (static_cast<size_t>(skin_index) >= model.skins.size())
            throw Error("a node refers to a skin that is not there", path);
        const tinygltf::Skin& skin = model.skins[skin_index];
        if (skin.inverseBindMatrices < 0)
            throw Error("the skin has no inverse bind matrices, so its bind pose is not known", path,
                        "export the body with them");
        const AccessorData matrix = read_accessor(model, skin.inverseBindMatrices, 16, path);
        std::vector<RiggedBone> bone;
        for (size_t i = 0; i < skin.joints.size(); ++i) {
            const int joint = skin.joints[i];
            if (joint < 0 || static_cast<size_t>(joint) >= model.nodes.size() || static_cast<int>(i) >= matrix.count)
                throw Error("joint " + std::to_string(i) + " of the skin is no node, or has no bind matrix", path);
            const Eigen::Matrix4d offset = Eigen::Map<const Eigen::Matrix4d>(matrix.value.data() + 16 * i);
            bone.push_back({"", node_index[joint], offset});
        }
        return bone;
    }

    /// Joins JOINTS_0, JOINTS_1 ... and WEIGHTS_0, WEIGHTS_1 ... of each vertex.
    void add_influences(const tinygltf::Primitive& primitive, RiggedMesh& mesh) const {
        std::vector<AccessorData> joint, weight;
        for (int set = 0; primitive.attributes.count("WEIGHTS_" + std::to_string(set)); ++set) {
            const auto found = primitive.attributes.find("JOINTS_" + std::to_string(set));
            if (found == primitive.attributes.end())
                throw Error("mesh '" + mesh.name + "' has weights without joints", path);
            joint.push_back(read_accessor(model, found->second, 4, path));
            weight.push_back(read_accessor(model, primitive.attributes.at("WEIGHTS_" + std::to_string(set)), 4, path));
            mesh.weight_step = std::max(mesh.weight_step, weight.back().step);
            if (joint.back().count != mesh.position.rows() || weight.back().count != mesh.position.rows())
                throw Error("mesh '" + mesh.name + "' has not one set of weights for each vertex", path);
        }
        mesh.influence_offset.assign(1, 0);
        for (int v = 0; v < mesh.position.rows(); ++v) {
            for (size_t set = 0; set < joint.size(); ++set)
                for (int i = 4 * v; i < 4 * v + 4; ++i)
                    if (weight[set].value[i] != 0) add_influence(v, joint[set].value[i], weight[set].value[i], mesh);
            mesh.influence_offset.push_back(static_cast<int>(mesh.influence_bone.size()));
        }
    }

    void add_influence(int v, double joint, double weight, RiggedMesh& mesh) const {
        const std::string name = "vertex " + std::to_string(v) + " of mesh '" + mesh.name + "'";
        if (!std::isfinite(weight)) throw Error("a weight of " + name + " is not finite", path);
        if (!(joint >= 0 && joint < static_cast<double>(mesh.bone.size())))
            throw Error(name + " hangs on joint " + whole(joint) + " of a skin of " + std::to_string(mesh.bone.size()),
                        path);
        mesh.influence_bone.push_back(static_cast<int>(joint));
        mesh.influence_value.push_back(weight);
    }

    RiggedMesh read(const tinygltf::Node& node, int node_number, const tinygltf::Primitive& primitive) const {
        RiggedMesh mesh;
        const std::string& name = model.meshes[node.mesh].name;
        mesh.name = name.empty() ? node.name : name;
        mesh.node = node_number;
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) throw Error("mesh '" + mesh.name + "' has no positions", path);
        mesh.position = vectors(position->second);
        for (int v = 0; v < mesh.position.rows(); ++v)
            if (!mesh.position.row(v).allFinite())
                throw Error("vertex " + std::to_string(v) + " of mesh '" + mesh.name + "' is not finite", path);
        mesh.triangle = triangles(primitive, static_cast<int>(mesh.position.rows()));
        const auto texture = primitive.attributes.find("TEXCOORD_0");
        if (texture != primitive.attributes.end()) {
            const AccessorData data = read_accessor(model, texture->second, 2, path);
            if (data.count != mesh.position.rows())
                throw Error("mesh '" + mesh.name + "' has not one texture coordinate for each vertex", path);
            mesh.texture = Eigen::Map<const PlanePositions>(data.value.data(), data.count, 2);
            // glTF counts v downwards from the top of the image; upwards is what the other formats do.
            mesh.texture.col(1) = 1 - mesh.texture.col(1).array();
        }
        if (node.skin >= 0) {
            mesh.bone = bones(node.skin);
            add_influences(primitive, mesh);
        }
        return mesh;
    }
};

}  // namespace

bool is_gltf(const std::string& path) {
    for (const char* extension : {".gltf", ".glb", ".vrm"})
        if (has_extension(path, extension)) return true;
    char magic[4] = {};
    std::ifstream(path, std::ios::binary).read(magic, 4);
    return std::string(magic, 4) == "glTF";
}

RiggedFile read_gltf(const std::string& path) {
    const tinygltf::Model model = load_model(path);
    RiggedFile file;
    const std::vector<int> node_index = add_nodes(model, path, file);
    const PrimitiveReader reader{model, path, node_index};
    Eigen::Index vertices = 0;
    for (size_t n = 0; n < model.nodes.size(); ++n) {
        const tinygltf::Node& node = model.nodes[n];
        if (node.mesh < 0) continue;
        if (static_cast<size_t>(node.mesh) >= model.meshes.size())
            throw Error("node " + std::to_string(n) + " refers to a mesh that is not there", path);
        for (const tinygltf::Primitive& primitive : model.meshes[node.mesh].primitives) {
            RiggedMesh mesh = reader.read(node, node_index[n], primitive);
            for (RiggedBone& bone : mesh.bone) bone.name = file.node[bone.node].name;
            // A few bytes can show one mesh many times over.
            vertices += mesh.position.rows();
            if (vertices > most_vertices)
                throw Error("the scene has more than " + std::to_string(most_vertices) + " vertices", path);
            if (mesh.triangle.rows() > 0) file.mesh.push_back(std::move(mesh));
        }
    }
    return file;
}

}  // namespace toile::files

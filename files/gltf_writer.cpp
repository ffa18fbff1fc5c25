#include "files/gltf_writer.h"

#include <libxml/xmlstring.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "files/gltf_buffer.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

/// JSON holds UTF-8 alone.
std::string json_name(std::string name) {
    if (xmlCheckUTF8(reinterpret_cast<const unsigned char*>(name.c_str()))) return name;
    for (char& c : name)
        if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    return name;
}

/// What glTF wants, of a component of sRGB.
double linear_light(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// Unit normals: a vertex without any gets one that points up.
Positions drawn_normals(const Triangles& triangle, const Positions& position) {
    Positions normal = vertex_normals(triangle, position);
    for (int v = 0; v < normal.rows(); ++v)
        if (normal.row(v).squaredNorm() < 0.5) normal.row(v) << 0, 1, 0;
    return normal;
}

}  // namespace

struct GltfWriter::Impl {
    Impl(const std::string& path, int samples, double rate) : file(path), buffer(model, path), sample_count(samples) {
        model.asset.version = "2.0";
        model.asset.generator = "toile";
        model.scenes.resize(1);
        model.defaultScene = 0;
        if (samples == 0) return;
        // One key more than there are samples: the last sample is shown as long as the others.
        std::vector<float> seconds;
        for (int k = 0; k <= samples; ++k) seconds.push_back(static_cast<float>(k / rate));
        times = buffer.add_times(seconds);
        model.animations.resize(1);
        model.animations[0].name = "samples";
    }

    int add_material(const NamedMesh& mesh) {
        tinygltf::Material material;
        material.name = json_name(mesh.name);
        material.doubleSided = true;
        material.pbrMetallicRoughness.baseColorFactor = {mesh.color[0], mesh.color[1], mesh.color[2], 1};
        material.pbrMetallicRoughness.metallicFactor = 0;
        material.pbrMetallicRoughness.roughnessFactor = 0.8;
        model.materials.push_back(std::move(material));
        return static_cast<int>(model.materials.size()) - 1;
    }

    /// Adds the mesh with its node, which is returned.
    int add_mesh(const NamedMesh& mesh, const Positions& normal) {
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.attributes["POSITION"] = buffer.add_vectors(mesh.position, true);
        primitive.attributes["NORMAL"] = buffer.add_vectors(normal, false);
        if (mesh.vertex_color.rows() > 0)
            primitive.attributes["COLOR_0"] = buffer.add_vectors(mesh.vertex_color.unaryExpr(&linear_light), false);
        primitive.indices = buffer.add_indices(mesh.triangle);
        primitive.material = add_material(mesh);
        tinygltf::Mesh added;
        added.name = json_name(mesh.name);
        added.primitives.push_back(std::move(primitive));
        model.meshes.push_back(std::move(added));
        const int node = add_node(mesh.name);
        model.nodes[node].mesh = static_cast<int>(model.meshes.size()) - 1;
        model.scenes[0].nodes.push_back(node);
        return node;
    }

    int add_node(const std::string& name) {
        tinygltf::Node node;
        node.name = json_name(name);
        model.nodes.push_back(std::move(node));
        return static_cast<int>(model.nodes.size()) - 1;
    }

    /// Keys `value` (those of each sample, then the last once more) for `path` of a node.
    void animate(int node, const std::string& path, int value) {
        tinygltf::AnimationSampler sampler;
        sampler.input = times;
        sampler.output = value;
        sampler.interpolation = "STEP";
        tinygltf::AnimationChannel channel;
        channel.sampler = static_cast<int>(model.animations[0].samplers.size());
        channel.target_node = node;
        channel.target_path = path;
        model.animations[0].samplers.push_back(std::move(sampler));
        model.animations[0].channels.push_back(std::move(channel));
    }

    void add_weight_sets(tinygltf::Primitive& primitive, const GltfSkin& skin);
    void end_morphing_mesh();

    NewFile file;
    tinygltf::Model model;
    GltfBuffer buffer;
    int sample_count = 0, times = -1;

    NamedMesh morphing;  ///< the mesh begun last
    Positions morphing_normal;
    int morphing_node = -1;
};

GltfWriter::GltfWriter(const std::string& path, int samples, double rate)
    : impl_(std::make_unique<Impl>(path, samples, rate)) {}
GltfWriter::~GltfWriter() = default;

void GltfWriter::add_mesh(const NamedMesh& mesh) {
    impl_->end_morphing_mesh();
    if (mesh.position.rows() == 0 || mesh.triangle.rows() == 0) return;  // glTF knows no empty accessor
    impl_->add_mesh(mesh, drawn_normals(mesh.triangle, mesh.position));
}

void GltfWriter::begin_morphing_mesh(const NamedMesh& mesh) {
    Impl& impl = *impl_;
    impl.end_morphing_mesh();
    const double samples = impl.sample_count, vertices = static_cast<double>(mesh.position.rows());
    impl.buffer.reserve(24 * vertices * (samples + 1) + 12.0 * static_cast<double>(mesh.triangle.rows()) +
                        4 * samples * (samples + 1));
    impl.morphing = mesh;
    impl.morphing_normal = drawn_normals(mesh.triangle, mesh.position);
    impl.morphing_node = impl.add_mesh(mesh, impl.morphing_normal);
    tinygltf::Mesh& added = impl.model.meshes.back();
    added.weights.assign(static_cast<size_t>(impl.sample_count), 0.0);
    added.weights.front() = 1;
    added.extras = tinygltf::Value(tinygltf::Value::Object{{"targetNames", tinygltf::Value(tinygltf::Value::Array())}});
}

void GltfWriter::add_target(const std::string& name, const Positions& position) {
    Impl& impl = *impl_;
    tinygltf::Mesh& mesh = impl.model.meshes[impl.model.nodes.at(impl.morphing_node).mesh];
    std::map<std::string, int> target;
    target["POSITION"] = impl.buffer.add_vectors(position - impl.morphing.position, true);
    target["NORMAL"] =
        impl.buffer.add_vectors(drawn_normals(impl.morphing.triangle, position) - impl.morphing_normal, false);
    mesh.primitives[0].targets.push_back(std::move(target));
    mesh.extras.Get<tinygltf::Value::Object>()["targetNames"].Get<tinygltf::Value::Array>().emplace_back(
        json_name(name));
}

void GltfWriter::Impl::end_morphing_mesh() {
    if (morphing_node < 0) return;
    const auto samples = static_cast<size_t>(sample_count);
    if (model.meshes[model.nodes[morphing_node].mesh].primitives[0].targets.size() != samples)
        throw std::logic_error("a morphing mesh lacks samples");
    std::vector<float> weight((samples + 1) * samples, 0.0f);
    for (size_t key = 0; key <= samples; ++key) weight[key * samples + std::min(key, samples - 1)] = 1;
    animate(morphing_node, "weights",
            buffer.add_floats(weight.data(), weight.size(), static_cast<int>(weight.size()), TINYGLTF_TYPE_SCALAR));
    morphing_node = -1;
}

/// Four joints a set, the heaviest first: programs that know but one set lose the least.
void GltfWriter::Impl::add_weight_sets(tinygltf::Primitive& primitive, const GltfSkin& skin) {
    const size_t vertices = skin.weight_offset.size() - 1;
    int most = 1;
    for (size_t v = 0; v < vertices; ++v) most = std::max(most, skin.weight_offset[v + 1] - skin.weight_offset[v]);
    const int sets = (most + 3) / 4;
    std::vector<std::vector<std::uint16_t>> joint(sets, std::vector<std::uint16_t>(4 * vertices, 0));
    std::vector<std::vector<float>> weight(sets, std::vector<float>(4 * vertices, 0.0f));
    for (size_t v = 0; v < vertices; ++v) {
        std::vector<int> entry(skin.weight_offset[v + 1] - skin.weight_offset[v]);
        std::iota(entry.begin(), entry.end(), skin.weight_offset[v]);
        std::stable_sort(entry.begin(), entry.end(),
                         [&](int a, int b) { return skin.weight_value[a] > skin.weight_value[b]; });
        for (size_t i = 0; i < entry.size(); ++i) {
            joint[i / 4][4 * v + i % 4] = static_cast<std::uint16_t>(skin.weight_joint[entry[i]]);
            weight[i / 4][4 * v + i % 4] = static_cast<float>(skin.weight_value[entry[i]]);
        }
    }
    for (int set = 0; set < sets; ++set) {
        primitive.attributes["JOINTS_" + std::to_string(set)] = buffer.add_joints(joint[set]);
        primitive.attributes["WEIGHTS_" + std::to_string(set)] =
            buffer.add_floats(weight[set].data(), weight[set].size(), static_cast<int>(vertices), TINYGLTF_TYPE_VEC4,
                              TINYGLTF_TARGET_ARRAY_BUFFER);
    }
}

void GltfWriter::add_skinned_mesh(const NamedMesh& mesh, const GltfSkin& skin,
                                  const std::vector<FloatRows<4>>& rotation) {
    Impl& impl = *impl_;
    impl.end_morphing_mesh();
    const int mesh_node = impl.add_mesh(mesh, drawn_normals(mesh.triangle, mesh.position));
    impl.add_weight_sets(impl.model.meshes.back().primitives[0], skin);
    const auto joints = static_cast<int>(skin.joint_name.size());
    tinygltf::Skin added;
    added.name = json_name(mesh.name);
    const auto first = static_cast<int>(impl.model.nodes.size());
    std::vector<float> inverse_bind;
    for (int j = 0; j < joints; ++j) {
        const int node = impl.add_node(skin.joint_name[j]);
        added.joints.push_back(node);
        (skin.joint_parent[j] < 0 ? impl.model.scenes[0].nodes
                                  : impl.model.nodes[first + skin.joint_parent[j]].children)
            .push_back(node);
        for (int axis = 0; axis < 3; ++axis) impl.model.nodes[node].translation.push_back(skin.translation(j, axis));
        for (int k = 0; k < 4; ++k) impl.model.nodes[node].rotation.push_back(rotation[j](0, k));
        FloatRows<4> keys(impl.sample_count + 1, 4);
        keys << rotation[j], rotation[j].bottomRows(1);
        impl.animate(node, "rotation",
                     impl.buffer.add_floats(keys.data(), static_cast<size_t>(keys.size()),
                                            static_cast<int>(keys.rows()), TINYGLTF_TYPE_VEC4));
        const Eigen::Matrix4f inverse =  // column-major, as glTF has it
            Eigen::Isometry3d(skin.joint_bind[j]).inverse().matrix().cast<float>();
        inverse_bind.insert(inverse_bind.end(), inverse.data(), inverse.data() + 16);
    }
    added.inverseBindMatrices =
        impl.buffer.add_floats(inverse_bind.data(), inverse_bind.size(), joints, TINYGLTF_TYPE_MAT4);
    impl.model.nodes[mesh_node].skin = static_cast<int>(impl.model.skins.size());
    impl.model.skins.push_back(std::move(added));
}

void GltfWriter::commit() {
    Impl& impl = *impl_;
    impl.end_morphing_mesh();
    if (impl.model.meshes.empty()) throw Error("there are no triangles to write", impl.file.path());
    std::ofstream stream(impl.file.partial(), std::ios::binary);
    errno = 0;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&impl.model, stream, false, true) || !stream.flush())
        throw Error("cannot write the file: " + write_failure(errno != 0 ? errno : EIO), impl.file.path(),
                    "make room, or write to another disk");
    stream.close();
    impl.file.commit();
}

}  // namespace toile::files

#include "tests/support/rigged_gltf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace toile::testing_support {
namespace {

std::string base64(const std::string& bytes) {
    static const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t block = 0;
        for (size_t k = 0; k < 3; ++k)
            block = block << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? letters[block >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

/// Numbers as JSON has them: without NaN, which only the buffer can hold.
template <typename Values>
std::string list(const Values& values) {
    std::ostringstream out;
    out.precision(17);
    for (long i = 0; i < static_cast<long>(values.size()); ++i) out << (i ? "," : "") << values[i];
    return "[" + out.str() + "]";
}

struct Writer {
    std::string buffer;
    std::vector<std::string> view, accessor, mesh, node, skin;

    template <typename T>
    int add(const std::vector<T>& value, int component_type, const std::string& type, size_t components,
            bool normalized = false) {
        buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
        view.push_back("{\"buffer\":0,\"byteOffset\":" + std::to_string(buffer.size()) +
                       ",\"byteLength\":" + std::to_string(value.size() * sizeof(T)) + "}");
        buffer.append(reinterpret_cast<const char*>(value.data()), value.size() * sizeof(T));
        accessor.push_back("{\"bufferView\":" + std::to_string(view.size() - 1) + ",\"componentType\":" +
                           std::to_string(component_type) + ",\"count\":" + std::to_string(value.size() / components) +
                           ",\"type\":\"" + type + "\"" + (normalized ? ",\"normalized\":true}" : "}"));
        return static_cast<int>(accessor.size()) - 1;
    }

    template <typename Rows>
    int add_rows(const Rows& rows, const std::string& type) {
        std::vector<float> value(rows.data(), rows.data() + rows.size());
        return add(value, 5126, type, static_cast<size_t>(rows.cols()));
    }

    int add_weights(const std::vector<double>& weight, WeightFormat format) {
        if (format == WeightFormat::float32)
            return add(std::vector<float>(weight.begin(), weight.end()), 5126, "VEC4", 4);
        if (format == WeightFormat::unsigned_byte) {
            std::vector<uint8_t> value;
            for (const double w : weight) value.push_back(static_cast<uint8_t>(std::lround(w * 255)));
            return add(value, 5121, "VEC4", 4, true);
        }
        std::vector<uint16_t> value;
        for (const double w : weight) value.push_back(static_cast<uint16_t>(std::lround(w * 65535)));
        return add(value, 5123, "VEC4", 4, true);
    }

    std::string influences(const GltfMesh& data) {
        size_t most = 0;
        for (const auto& of_vertex : data.influence) most = std::max(most, of_vertex.size());
        std::string attributes;
        for (size_t set = 0; set * 4 < most; ++set) {
            std::vector<uint16_t> joint;
            std::vector<double> weight;
            for (const auto& of_vertex : data.influence) {
                for (size_t i = 4 * set; i < 4 * set + 4; ++i) {
                    joint.push_back(i < of_vertex.size() ? static_cast<uint16_t>(of_vertex[i].first) : 0);
                    weight.push_back(i < of_vertex.size() ? of_vertex[i].second : 0);
                }
            }
            const std::string number = std::to_string(set);
            attributes += ",\"JOINTS_" + number + "\":" + std::to_string(add(joint, 5123, "VEC4", 4));
            attributes += ",\"WEIGHTS_" + number + "\":" + std::to_string(add_weights(weight, data.weight_format));
        }
        return attributes;
    }

    void add_mesh(const GltfMesh& data) {
        std::string attributes = "\"POSITION\":" + std::to_string(add_rows(data.position, "VEC3"));
        if (data.texture.rows() > 0) attributes += ",\"TEXCOORD_0\":" + std::to_string(add_rows(data.texture, "VEC2"));
        attributes += influences(data);
        const std::vector<uint32_t> corner(data.triangle.data(), data.triangle.data() + data.triangle.size());
        const int indices = add(corner, 5125, "SCALAR", 1);
        mesh.push_back("{\"name\":\"" + data.name + "\",\"primitives\":[{\"attributes\":{" + attributes +
                       "},\"indices\":" + std::to_string(indices) + "}]}");
        node.push_back("{\"name\":\"" + data.name + " node\",\"mesh\":" + std::to_string(mesh.size() - 1) +
                       (data.skin < 0 ? "" : ",\"skin\":" + std::to_string(data.skin)) + "}");
    }

    void add_node(const GltfScene& scene, size_t index) {
        const GltfNode& data = scene.node[index];
        std::vector<int> child;
        for (size_t n = 0; n < scene.node.size(); ++n)
            if (scene.node[n].parent == static_cast<int>(index)) child.push_back(static_cast<int>(n));
        node.push_back("{\"name\":\"" + data.name + "\",\"translation\":" + list(data.translation) + ",\"rotation\":" +
                       list(data.rotation) + ",\"scale\":" + list(Eigen::Vector3d::Constant(data.scale).eval()) +
                       (child.empty() ? "" : ",\"children\":" + list(child)) + "}");
    }

    void add_skin(const GltfSkin& data) {
        std::vector<float> value;
        for (const Eigen::Matrix4d& m : data.inverse_bind) value.insert(value.end(), m.data(), m.data() + 16);
        std::string text = "{\"joints\":" + list(data.joint);
        if (!value.empty()) text += ",\"inverseBindMatrices\":" + std::to_string(add(value, 5126, "MAT4", 16));
        skin.push_back(text + "}");
    }
};

std::string joined(const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items) text += (text.empty() ? "" : ",") + item;
    return text;
}

/// Appends a closed box around the segment from a to b, hung on one joint.
void add_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double thickness, int joint, GltfMesh& mesh) {
    const Eigen::Vector3d lower = a.cwiseMin(b).array() - thickness, upper = a.cwiseMax(b).array() + thickness;
    const long first = mesh.position.rows();
    mesh.position.conservativeResize(first + 8, 3);
    for (int k = 0; k < 8; ++k) {
        mesh.position.row(first + k) << (k & 1 ? upper : lower).x(), (k & 2 ? upper : lower).y(),
            (k & 4 ? upper : lower).z();
        mesh.influence.push_back({{joint, 1.0}});
    }
    const int face[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const long row = mesh.triangle.rows();
    mesh.triangle.conservativeResize(row + 12, 3);
    for (int f = 0; f < 12; ++f)
        for (int corner = 0; corner < 3; ++corner)
            mesh.triangle(row + f, corner) = static_cast<int>(first) + face[f][corner];
}

/// The joints of a person as they are added: names, places, and where each bone ends.
struct PersonBuilder {
    GltfScene scene;
    std::vector<Eigen::Vector3d> place;

    int add(const std::string& name, int parent, const Eigen::Vector3d& at, const Eigen::Vector3d& end,
            double thickness) {
        if (name.empty()) return parent;
        const int index = static_cast<int>(scene.node.size());
        scene.node.push_back({name, parent, parent < 0 ? at : Eigen::Vector3d(at - place[parent])});
        place.push_back(at);
        scene.skin[0].joint.push_back(index);
        Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
        inverse.topRightCorner<3, 1>() = -at;
        scene.skin[0].inverse_bind.push_back(inverse);
        add_box(at, end, thickness, index, scene.mesh[0]);
        return index;
    }

    void add_side(const std::vector<std::string>& name, double side, int pelvis, int chest) {
        const auto at = [&](double x, double y, double z) { return Eigen::Vector3d(side * x, y, z); };
        const int clavicle = add(name[0], chest, at(0.03, 1.40, 0), at(0.14, 1.42, 0), 0.02);
        const int upper = add(name[1], clavicle, at(0.17, 1.40, 0), at(0.42, 1.40, 0), 0.04);
        const int lower = add(name[2], upper, at(0.45, 1.40, 0), at(0.68, 1.40, 0), 0.03);
        add(name[3], lower, at(0.70, 1.40, 0), at(0.86, 1.40, 0.02), 0.02);
        const int thigh = add(name[4], pelvis, at(0.10, 0.90, 0), at(0.10, 0.52, 0), 0.07);
        const int shin = add(name[5], thigh, at(0.10, 0.48, 0), at(0.10, 0.12, 0), 0.05);
        add(name[6], shin, at(0.10, 0.08, 0), at(0.10, 0.03, 0.18), 0.03);
    }
};

}  // namespace

std::string gltf_text(const GltfScene& scene) {
    Writer writer;
    for (size_t n = 0; n < scene.node.size(); ++n) writer.add_node(scene, n);
    std::vector<int> root;
    for (size_t n = 0; n < scene.node.size(); ++n)
        if (scene.node[n].parent < 0) root.push_back(static_cast<int>(n));
    for (const GltfMesh& mesh : scene.mesh) {
        root.push_back(static_cast<int>(writer.node.size()));
        writer.add_mesh(mesh);
    }
    for (const GltfSkin& skin : scene.skin) writer.add_skin(skin);
    std::string text = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":" + list(root) +
                       "}],\"nodes\":[" + joined(writer.node) + "],\"meshes\":[" + joined(writer.mesh) + "]";
    if (!writer.skin.empty()) text += ",\"skins\":[" + joined(writer.skin) + "]";
    return text + ",\"accessors\":[" + joined(writer.accessor) + "],\"bufferViews\":[" + joined(writer.view) +
           "],\"buffers\":[{\"byteLength\":" + std::to_string(writer.buffer.size()) +
           ",\"uri\":\"data:application/octet-stream;base64," + base64(writer.buffer) + "\"}]}";
}

HumanNames mixamo_names() {
    HumanNames names{
        "mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine2", "mixamorig:Neck", "mixamorig:Head", {}, {}};
    for (const std::string word : {"Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot"}) {
        names.left.push_back("mixamorig:Left" + word);
        names.right.push_back("mixamorig:Right" + word);
    }
    return names;
}

GltfScene box_person(const HumanNames& names) {
    PersonBuilder person;
    person.scene.skin.resize(1);
    person.scene.mesh.resize(1);
    person.scene.mesh[0].name = "body";
    person.scene.mesh[0].skin = 0;
    using Eigen::Vector3d;
    const int pelvis = person.add(names.pelvis, -1, {0, 0.95, 0}, {0, 1.02, 0}, 0.09);
    const int spine = person.add(names.spine, pelvis, {0, 1.08, 0}, {0, 1.18, 0}, 0.09);
    const int chest = person.add(names.chest, spine, {0, 1.22, 0}, {0, 1.38, 0}, 0.10);
    const int neck = person.add(names.neck, chest, {0, 1.45, 0}, {0, 1.50, 0}, 0.04);
    person.add(names.head, neck, {0, 1.54, 0}, {0, 1.62, 0.02}, 0.08);
    person.add_side(names.left, 1, pelvis, chest);
    person.add_side(names.right, -1, pelvis, chest);
    return person.scene;
}

void transform_bind(GltfScene& scene, const Eigen::Matrix4d& m) {
    for (GltfMesh& mesh : scene.mesh)
        mesh.position = (mesh.position * m.topLeftCorner<3, 3>().transpose()).rowwise() +
                        m.topRightCorner<3, 1>().transpose().eval();
    for (GltfSkin& skin : scene.skin)
        for (Eigen::Matrix4d& inverse : skin.inverse_bind) inverse = inverse * m.inverse();
}

std::string write_test_file(const std::string& name, const std::string& bytes) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) /
        ("toile_" + std::to_string(::getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::create_directories(folder);
    const std::string path = (folder / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

}  // namespace toile::testing_support

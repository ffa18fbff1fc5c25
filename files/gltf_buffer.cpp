#include "files/gltf_buffer.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "cloth/error.h"
#include "files/gltf_writer.h"

namespace toile::files {

GltfBuffer::GltfBuffer(tinygltf::Model& model, std::string path) : model_(model), path_(std::move(path)) {
    model_.buffers.resize(1);
}

void GltfBuffer::need(double bytes) const {
    const double total = static_cast<double>(model_.buffers[0].data.size()) + bytes;
    if (total <= static_cast<double>(gltf_limit)) return;
    char text[120];
    std::snprintf(text, sizeof text, "the glTF file would take %.1f GB, more than the 2.1 GB that programs load",
                  total * 1e-9);
    throw Error(text, path_, "choose fewer samples with --pose or --at-most, or another format");
}

void GltfBuffer::reserve(double bytes) {
    need(bytes);
    model_.buffers[0].data.reserve(model_.buffers[0].data.size() + static_cast<size_t>(bytes) + (1 << 20));
}

int GltfBuffer::add(const void* data, size_t bytes, int elements, int component, int type, int target) {
    need(static_cast<double>(bytes));
    std::vector<unsigned char>& buffer = model_.buffers[0].data;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* first = static_cast<const unsigned char*>(data);
    buffer.insert(buffer.end(), first, first + bytes);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size());
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = static_cast<size_t>(elements);
    model_.bufferViews.push_back(std::move(view));
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
}

int GltfBuffer::add_vectors(const Positions& rows, bool bounds) {
    const FloatRows<3> value = rows.cast<float>();
    const int index =
        add(value.data(), sizeof(float) * static_cast<size_t>(value.size()), static_cast<int>(value.rows()),
            TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
    if (bounds)
        for (int axis = 0; axis < 3; ++axis) {
            model_.accessors[index].minValues.push_back(value.col(axis).minCoeff());
            model_.accessors[index].maxValues.push_back(value.col(axis).maxCoeff());
        }
    return index;
}

int GltfBuffer::add_indices(const Triangles& triangle) {
    const Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor> value = triangle.cast<std::uint32_t>();
    return add(value.data(), sizeof(std::uint32_t) * static_cast<size_t>(value.size()), static_cast<int>(value.size()),
               TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

int GltfBuffer::add_times(const std::vector<float>& seconds) {
    const int index =
        add_floats(seconds.data(), seconds.size(), static_cast<int>(seconds.size()), TINYGLTF_TYPE_SCALAR);
    model_.accessors[index].minValues = {seconds.front()};
    model_.accessors[index].maxValues = {seconds.back()};
    return index;
}

int GltfBuffer::add_floats(const float* value, size_t count, int elements, int type, int target) {
    return add(value, sizeof(float) * count, elements, TINYGLTF_COMPONENT_TYPE_FLOAT, type, target);
}

int GltfBuffer::add_joints(const std::vector<std::uint16_t>& joint) {
    const int target = TINYGLTF_TARGET_ARRAY_BUFFER;
    return add(joint.data(), sizeof(std::uint16_t) * joint.size(), static_cast<int>(joint.size() / 4),
               TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, target);
}

}  // namespace toile::files

#include "files/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "cloth/error.h"

namespace toile::files {
namespace {

template <typename T>
double number_at(const unsigned char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if (!normalized || !std::numeric_limits<T>::is_integer) return static_cast<double>(value);
    return std::max(-1.0, static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()));
}

double number_at(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return number_at<int8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return number_at<uint8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return number_at<int16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return number_at<uint16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return number_at<uint32_t>(bytes, normalized);
        default:
            return number_at<float>(bytes, normalized);
    }
}

size_t size_of(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

/// A run of elements in a buffer, checked to lie inside it.
struct Elements {
    const unsigned char* start;
    size_t stride;
};

Elements elements(const tinygltf::Model& model, int view_index, size_t offset, size_t element_size, size_t count,
                  bool strided, const std::string& path) {
    const Error outside("an accessor points outside its buffer", path, "the file is damaged: export it again");
    if (view_index < 0 || static_cast<size_t>(view_index) >= model.bufferViews.size()) throw outside;
    const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(view_index)];
    if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model.buffers.size()) throw outside;
    const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(view.buffer)].data;
    const size_t stride = strided && view.byteStride > 0 ? view.byteStride : element_size;
    // Compared step by step, so that no sum or product can wrap around.
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset || offset > view.byteLength)
        throw outside;
    const size_t room = view.byteLength - offset;
    if (count > 0 && (element_size > room || (count - 1) > (room - element_size) / stride)) throw outside;
    return {data.data() + view.byteOffset + offset, stride};
}

void replace_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, AccessorData& data,
                    const std::string& path) {
    const auto& sparse = accessor.sparse;
    const size_t size = size_of(accessor.componentType), components = static_cast<size_t>(data.components);
    const size_t index_size = size_of(sparse.indices.componentType);
    if (sparse.count < 0 || index_size == 0) throw Error("a sparse accessor is damaged", path);
    const size_t count = static_cast<size_t>(sparse.count);
    const Elements index = elements(model, sparse.indices.bufferView, static_cast<size_t>(sparse.indices.byteOffset),
                                    index_size, count, false, path);
    const Elements value = elements(model, sparse.values.bufferView, static_cast<size_t>(sparse.values.byteOffset),
                                    size * components, count, false, path);
    for (size_t i = 0; i < count; ++i) {
        const double at = number_at(index.start + i * index.stride, sparse.indices.componentType, false);
        if (!(at >= 0 && at < data.count)) throw Error("a sparse accessor replaces an element that is not there", path);
        for (size_t c = 0; c < components; ++c)
            data.value[static_cast<size_t>(at) * components + c] =
                number_at(value.start + i * value.stride + c * size, accessor.componentType, accessor.normalized);
    }
}

}  // namespace

AccessorData read_accessor(const tinygltf::Model& model, int index, int components, const std::string& path) {
    if (index < 0 || static_cast<size_t>(index) >= model.accessors.size())
        throw Error(
            "the file refers to accessor " + std::to_string(index) + " of " + std::to_string(model.accessors.size()),
            path);
    const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(index)];
    const size_t size = size_of(accessor.componentType);
    if (size == 0 || tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) != components)
        throw Error("accessor " + std::to_string(index) + " is not of the type its use asks for", path);
    if (accessor.count > 30'000'000) throw Error("accessor " + std::to_string(index) + " is too large", path);
    // Zeros but for sparse replacements: nothing in the file bears out the count.
    if (accessor.bufferView < 0 && accessor.count > 1'000'000)
        throw Error("accessor " + std::to_string(index) + " is too large to have no buffer", path);
    const size_t per_element = static_cast<size_t>(components);
    Elements run{nullptr, 0};
    if (accessor.bufferView >= 0 || !accessor.sparse.isSparse)
        run = elements(model, accessor.bufferView, accessor.byteOffset, size * per_element, accessor.count, true, path);
    AccessorData data{components, static_cast<int>(accessor.count), {}, 0};
    if (accessor.normalized && size < 4) data.step = 1 / (std::pow(2.0, 8.0 * static_cast<double>(size)) - 1);
    data.value.assign(accessor.count * per_element, 0.0);
    for (size_t i = 0; run.start && i < accessor.count; ++i)
        for (size_t c = 0; c < per_element; ++c)
            data.value[i * per_element + c] =
                number_at(run.start + i * run.stride + c * size, accessor.componentType, accessor.normalized);
    if (accessor.sparse.isSparse) replace_sparse(model, accessor, data, path);
    return data;
}

}  // namespace toile::files

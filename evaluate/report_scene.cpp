#include "evaluate/report_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "files/binary_text.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double steps = 65535;

template <typename Integer>
void append(std::vector<std::uint8_t>& bytes, Integer value) {
    static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
}

Json ends(const std::vector<double>& values) {
    return values.size() == 1 ? Json(values[0]) : Json(values);
}

Json as_json(const PackedNumbers& numbers) {
    return {{"blob", numbers.blob}, {"low", ends(numbers.low)}, {"high", ends(numbers.high)}, {"count", numbers.count}};
}

Json as_json(const SceneSample& sample) {
    Json error = Json::object(), cloth = Json::object(), images = Json::array();
    for (const auto& [view, millimetres] : sample.error_mm)
        error[view] = std::isfinite(millimetres) ? Json(millimetres) : Json(nullptr);
    for (const SceneCloth& one : sample.cloth) {
        Json fields = Json::object();
        for (const auto& [key, numbers] : one.fields) fields[key] = as_json(numbers);
        cloth[one.view] = {{"position", as_json(one.position)}, {"fields", fields}};
    }
    for (const SceneImage& image : sample.image) images.push_back({{"name", image.name}, {"src", image.src}});
    return {{"id", sample.id},   {"split", sample.split},
            {"error_mm", error}, {"body", sample.body ? as_json(*sample.body) : Json(nullptr)},
            {"cloth", cloth},    {"image", images}};
}

}  // namespace

PackedNumbers BlobStore::pack(const std::vector<float>& value, int columns) {
    PackedNumbers packed;
    packed.count = static_cast<std::int64_t>(value.size()) / columns;
    packed.low.assign(columns, std::numeric_limits<double>::infinity());
    packed.high.assign(columns, -std::numeric_limits<double>::infinity());
    for (size_t k = 0; k < value.size(); ++k) {
        if (!std::isfinite(value[k])) continue;
        double &low = packed.low[k % columns], &high = packed.high[k % columns];
        low = std::min<double>(low, value[k]);
        high = std::max<double>(high, value[k]);
    }
    for (int c = 0; c < columns; ++c)
        if (packed.low[c] > packed.high[c]) packed.low[c] = packed.high[c] = 0.0;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(value.size() * sizeof(std::uint16_t));
    for (size_t k = 0; k < value.size(); ++k) {
        const double low = packed.low[k % columns], width = packed.high[k % columns] - low;
        const bool told = std::isfinite(value[k]) && width > 0.0;
        append(bytes, static_cast<std::uint16_t>(told ? std::lround((value[k] - low) / width * steps) : 0));
    }
    packed.blob = add(bytes);
    return packed;
}

std::string BlobStore::pack(const std::vector<std::int32_t>& value) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(value.size() * sizeof(std::int32_t));
    for (const std::int32_t one : value) append(bytes, one);
    return add(bytes);
}

std::string BlobStore::add(const std::vector<std::uint8_t>& bytes) {
    blobs_.push_back({"blob-" + std::to_string(blobs_.size()), files::base64(files::deflated(bytes))});
    return blobs_.back().id;
}

size_t BlobStore::bytes() const {
    size_t sum = 0;
    for (const ReportBlob& blob : blobs_) sum += blob.text.size();
    return sum;
}

Json as_json(const ReportScene& scene) {
    Json views = Json::array(), fields = Json::array(), samples = Json::array();
    for (const SceneView& view : scene.views) views.push_back({{"key", view.key}, {"name", view.name}});
    for (const SceneField& field : scene.fields)
        fields.push_back({{"key", field.key},
                          {"name", field.name},
                          {"unit", field.unit},
                          {"low", field.low},
                          {"high", field.high},
                          {"map", field.map}});
    for (const SceneSample& sample : scene.samples) samples.push_back(as_json(sample));
    Json json{{"triangle", scene.triangle},
              {"body_triangle", scene.body_triangle.empty() ? Json(nullptr) : Json(scene.body_triangle)},
              {"views", views},
              {"fields", fields},
              {"samples", samples}};
    if (scene.mu) json["vertex_fields"] = {{"mu", as_json(*scene.mu)}};
    return json;
}

}  // namespace toile::evaluate

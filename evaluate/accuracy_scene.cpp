#include "evaluate/accuracy_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "evaluate/displacement_picture.h"
#include "files/hdf5_file.h"

namespace toile::evaluate {
namespace {

using files::any_size;
using files::Hdf5File;

constexpr std::array split_names{"train", "validation", "test"};
constexpr std::array known_views{"target", "predicted", "inextensibility", "quasistatic", "quasistatic_mu_vertex"};

/// A field of /shown/<view>, and what turns it into the unit it is shown in.
struct ShownField {
    const char *dataset, *name, *unit, *map;
    double factor;
};
constexpr std::array shown_fields{
    ShownField{"stretch", "stretch of the edges (length over rest length)", "", "stretch", 1.0},
    ShownField{"distance", "distance to the target", "mm", "sequential", 1e3},
    ShownField{"strain", "largest principal strain", "%", "diverging", 1e2}};

class SceneReader {
  public:
    explicit SceneReader(const std::string& path) : file_(Hdf5File::open(path)) {}

    std::optional<SceneData> read() {
        check_version();
        const files::Shape shape = file_.has("/shown/id") ? file_.shape("/shown/id") : files::Shape{0};
        if (shape.size() != 1 || shape[0] == 0) return {};
        count_ = shape[0];
        read_views();
        vertices_ = size_of(position(data_.scene.views.front()), {count_, any_size, 3}, 1);
        data_.scene.triangle = triangles("/mesh/triangle", vertices_);
        if (file_.has("/shown/body")) {
            body_vertices_ = size_of("/shown/body", {count_, any_size, 3}, 1);
            data_.scene.body_triangle = triangles("/body/triangle", body_vertices_);
        }
        const std::vector<std::int64_t> id = file_.read<std::int64_t>("/shown/id", {count_}).value;
        const std::vector<std::int8_t> split = file_.read<std::int8_t>("/shown/split", {count_}).value;
        for (std::int64_t k = 0; k < count_; ++k) {
            if (split[k] < 0 || split[k] >= static_cast<int>(split_names.size()))
                fail("/shown/split", "there is no split of number " + std::to_string(split[k]));
            data_.scene.samples.push_back(sample(k, id[k], split_names[split[k]]));
        }
        finish_fields();
        return std::move(data_);
    }

  private:
    [[noreturn]] void fail(const std::string& dataset, const std::string& what) const {
        throw Error(what, file_.path() + ":" + dataset, "let `toile evaluate accuracy` write it anew");
    }
    void check_version() const {
        if (!file_.has_attribute("/", "format") || file_.string_attribute("/", "format") != "toile accuracy")
            fail("/", "this is no file of `toile evaluate accuracy`");
        const std::int64_t version = file_.integer_attribute("/", "version");
        if (version != 1)
            fail("/", "this file is of version " + std::to_string(version) + "; this program reads version 1");
    }
    static std::string group(const SceneView& view) { return "/shown/" + view.key; }
    static std::string position(const SceneView& view) { return group(view) + "/position"; }

    std::int64_t size_of(const std::string& dataset, const files::Shape& expected, size_t dimension) const {
        const files::Shape shape = file_.shape(dataset);
        bool fits = shape.size() == expected.size();
        for (size_t k = 0; fits && k < shape.size(); ++k) fits = expected[k] == any_size || shape[k] == expected[k];
        if (!fits) fail(dataset, "its shape is " + files::shape_text(shape) + ", not " + files::shape_text(expected));
        return shape[dimension];
    }

    void read_views() {
        std::vector<std::string> keys(known_views.begin(), known_views.end());
        for (const std::string& key : file_.members("/shown"))
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
        for (const std::string& key : keys) {
            const SceneView view{key, key};
            if (!file_.has(group(view)) || file_.is_dataset(group(view)) || !file_.has(position(view))) continue;
            data_.scene.views.push_back(view);
            if (file_.has_attribute(group(view), "title"))
                data_.scene.views.back().name = file_.string_attribute(group(view), "title");
        }
        if (data_.scene.views.empty()) fail("/shown", "no cloth is there to show");
    }

    std::string triangles(const std::string& dataset, std::int64_t vertices) {
        const std::vector<std::int32_t> corner = file_.read<std::int32_t>(dataset, {any_size, 3}).value;
        for (const std::int32_t vertex : corner)
            if (vertex < 0 || vertex >= vertices)
                fail(dataset, "vertex " + std::to_string(vertex) + " is not among the " + std::to_string(vertices));
        return data_.store.pack(corner);
    }

    /// One sample's row; Error unless it is of this shape.
    std::vector<float> row(const std::string& dataset, std::int64_t sample, const files::Shape& shape) const {
        files::Shape expected{count_};
        expected.insert(expected.end(), shape.begin(), shape.end());
        size_of(dataset, expected, 0);
        return file_.read_rows<float>(dataset, sample, 1).value;
    }

    SceneSample sample(std::int64_t index, std::int64_t id, const std::string& split) {
        SceneSample sample;
        sample.id = id;
        sample.split = split;
        if (body_vertices_ > 0) sample.body = data_.store.pack(row("/shown/body", index, {body_vertices_, 3}), 3);
        for (const SceneView& view : data_.scene.views) add_cloth(sample, view, index);
        if (file_.has("/shown/image")) add_images(sample, index);
        return sample;
    }

    void add_cloth(SceneSample& sample, const SceneView& view, std::int64_t index) {
        const std::vector<float> place = row(position(view), index, {vertices_, 3});
        if (!std::all_of(place.begin(), place.end(), [](float one) { return std::isfinite(one); })) return;
        SceneCloth cloth{view.key, data_.store.pack(place, 3), {}};
        for (size_t k = 0; k < shown_fields.size(); ++k) {
            const std::string dataset = group(view) + "/" + shown_fields[k].dataset;
            if (!file_.has(dataset)) continue;
            std::vector<float> value = row(dataset, index, {vertices_});
            if (std::string(shown_fields[k].dataset) == "distance" && view.key != "target")
                sample.error_mm.emplace_back(view.key, 1e3 * root_mean_square(value));
            for (float& one : value) one = static_cast<float>(one * shown_fields[k].factor);
            range_[k] = std::max(range_[k], nearly_largest(value));
            present_[k] = true;
            cloth.fields.emplace_back(shown_fields[k].dataset, data_.store.pack(value, 1));
        }
        sample.cloth.push_back(std::move(cloth));
    }

    static double root_mean_square(const std::vector<float>& value) {
        double sum = 0.0;
        for (const double one : value) sum += one * one;
        return std::sqrt(sum / static_cast<double>(value.size()));
    }

    /// What 99 of 100 stay below: one vertex does not take the colours from all others.
    static double nearly_largest(std::vector<float> value) {
        std::erase_if(value, [](float one) { return !std::isfinite(one); });
        for (float& one : value) one = std::abs(one);
        if (value.empty()) return 0.0;
        const auto place = value.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(value.size() - 1));
        std::nth_element(value.begin(), place, value.end());
        return *place;
    }

    void add_images(SceneSample& sample, std::int64_t index) {
        const files::Shape shape = file_.shape("/shown/image");
        size_of("/shown/image", {count_, any_size, any_size, any_size}, 0);
        if (shape[1] % 3 != 0) fail("/shown/image", "its channels are no multiple of three");
        const std::vector<float> image = row("/shown/image", index, {shape[1], shape[2], shape[3]});
        for (DisplacementPicture& picture : displacement_pictures(
                 image, static_cast<int>(shape[1] / 3), static_cast<int>(shape[2]), static_cast<int>(shape[3])))
            sample.image.push_back({std::move(picture.name), std::move(picture.src)});
    }

    void finish_fields() {
        for (size_t k = 0; k < shown_fields.size(); ++k) {
            if (!present_[k]) continue;
            const ShownField& field = shown_fields[k];
            const std::string map = field.map;
            double high = range_[k] > 0.0 ? range_[k] : 1.0, low = map == "diverging" ? -high : 0.0;
            if (map == "stretch") low = 0.75, high = 1.25;
            data_.scene.fields.push_back({field.dataset, field.name, field.unit, low, high, map});
        }
        if (!file_.has("/mu/vertex")) return;
        // multipliers spread over decades
        std::vector<float> mu = file_.read<float>("/mu/vertex", {vertices_}).value;
        for (float& one : mu) one = std::log10(one);
        data_.scene.mu = data_.store.pack(mu, 1);
        data_.scene.fields.push_back({"mu", "decimal logarithm of the learned μ", "", data_.scene.mu->low[0],
                                      data_.scene.mu->high[0], "sequential"});
    }

    Hdf5File file_;
    SceneData data_;
    std::int64_t count_ = 0, vertices_ = 0, body_vertices_ = 0;
    std::array<double, shown_fields.size()> range_{};
    std::array<bool, shown_fields.size()> present_{};
};

}  // namespace

size_t SceneData::bytes() const {
    size_t sum = store.bytes();
    for (const SceneSample& sample : scene.samples)
        for (const SceneImage& image : sample.image) sum += image.src.size();
    return sum;
}

std::optional<SceneData> accuracy_scene(const std::string& folder) {
    const std::string path = (std::filesystem::path(folder) / "accuracy.h5").string();
    if (!std::filesystem::exists(path)) return {};
    return SceneReader(path).read();
}

}  // namespace toile::evaluate

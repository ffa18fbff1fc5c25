#include "evaluate/accuracy_file.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "files/hdf5_file.h"
#include "files/mesh_group.h"

namespace toile::evaluate {
namespace {

constexpr int deflate = 4;

files::Storage by_sample(files::Shape shape) {
    files::Shape chunk = std::move(shape);
    chunk.front() = 1;
    return {deflate, chunk};
}

void write_method(files::Hdf5File& file, const std::string& group, const MethodFigures& method) {
    const auto count = static_cast<std::int64_t>(method.sample.size());
    for (int q = 0; q < quantity_count; ++q) {
        const QuantityKind& kind = quantity_kind(q);
        std::vector<double> value;
        for (const QuantityValues& one : method.sample) value.push_back(one[static_cast<size_t>(q)]);
        file.write(group + "/" + kind.name, value, {count});
        file.set_attribute(group + "/" + kind.name, "unit", kind.unit);
    }
    file.write(group + "/status", method.status, {count});
    file.set_attribute(group, "title", method.title);
    file.set_attribute(group, "setting", method.setting);
}

void write_figures(files::Hdf5File& file, const AccuracyFigures& figures) {
    const auto count = static_cast<std::int64_t>(figures.id.size());
    file.write("/figures/id", figures.id, {count});
    file.write("/figures/split", std::vector<std::int8_t>(figures.split.begin(), figures.split.end()), {count});
    const auto write = [&](const PredictorFigures& predictor) {
        for (const MethodFigures& method : predictor.method)
            write_method(file, "/figures/" + predictor.predictor + "/" + method.method, method);
    };
    write(figures.truth);
    for (const PredictorFigures& predictor : figures.predictor) write(predictor);
}

/// Of the first predictor that it was learned for.
void write_mu(files::Hdf5File& file, const std::vector<LearnedMu>& learned) {
    if (learned.empty()) return;
    const MuFit& fit = learned.front().fit;
    file.write("/mu/global", std::vector<double>{fit.global.mu}, {});
    if (fit.vertex.mu.size() > 0) file.write("/mu/vertex", fit.vertex.mu.data(), {fit.vertex.mu.size()});
    file.set_attribute("/mu", "predictor", learned.front().predictor);
}

void append(std::vector<float>& to, const double* from, Eigen::Index count) {
    to.insert(to.end(), from, from + count);
}

void write_view(files::Hdf5File& file, const Shown& shown, size_t view) {
    const auto count = static_cast<std::int64_t>(shown.sample.size());
    const std::int64_t vertices = shown.sample.front().cloth[view].position.rows();
    std::vector<float> position, distance, stretch, strain;
    for (const ShownSample& sample : shown.sample) {
        const ShownSample::Cloth& cloth = sample.cloth[view];
        append(position, cloth.position.data(), cloth.position.size());
        append(distance, cloth.fields.distance.data(), vertices);
        append(stretch, cloth.fields.stretch.data(), vertices);
        append(strain, cloth.fields.strain.data(), vertices);
    }
    const std::string group = "/shown/" + shown.view[view].key;
    file.write(group + "/position", position, {count, vertices, 3}, by_sample({count, vertices, 3}));
    file.write(group + "/distance", distance, {count, vertices}, by_sample({count, vertices}));
    file.write(group + "/stretch", stretch, {count, vertices}, by_sample({count, vertices}));
    file.write(group + "/strain", strain, {count, vertices}, by_sample({count, vertices}));
    file.set_attribute(group, "title", shown.view[view].title);
}

void write_shown(files::Hdf5File& file, const files::DatasetHeader& header, const Shown& shown) {
    if (shown.sample.empty()) return;
    const auto count = static_cast<std::int64_t>(shown.sample.size());
    std::vector<std::int64_t> id;
    std::vector<std::int8_t> split;
    std::vector<float> body, image;
    for (const ShownSample& sample : shown.sample) {
        id.push_back(sample.id);
        split.push_back(static_cast<std::int8_t>(sample.split));
        append(body, sample.body.data(), sample.body.size());
        image.insert(image.end(), sample.image.begin(), sample.image.end());
    }
    file.write("/shown/id", id, {count});
    file.write("/shown/split", split, {count});
    if (!body.empty()) {
        const files::Shape shape{count, shown.sample.front().body.rows(), 3};
        file.write("/shown/body", body, shape, by_sample(shape));
    }
    if (!image.empty()) {
        const files::Shape shape{count, 3 * header.image->layers, header.image->size, header.image->size};
        file.write("/shown/image", image, shape, by_sample(shape));
    }
    for (size_t view = 0; view < shown.view.size(); ++view) write_view(file, shown, view);
}

}  // namespace

void write_accuracy_file(const std::string& path, const files::DatasetHeader& header, const Shown& shown,
                         const AccuracySummary& summary) {
    files::Hdf5File file = files::Hdf5File::create(path);
    file.set_attribute("/", "format", "toile accuracy");
    file.set_attribute("/", "version", 1);
    file.set_attribute("/", "program_version", TOILE_VERSION);
    files::write_mesh_group(file, header.mesh, deflate);
    if (header.body) {
        const auto& triangle = header.body->triangle;
        file.write("/body/triangle", triangle.data(), {triangle.rows(), 3}, {deflate, {}});
    }
    write_figures(file, summary.figures);
    write_mu(file, summary.mu);
    write_shown(file, header, shown);
    file.close();
}

}  // namespace toile::evaluate

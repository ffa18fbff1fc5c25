#include "files/predictions_file.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr const char* id_name = "/samples/id";
constexpr const char* predicted_name = "/samples/predicted";
constexpr const char* layout_mend = "a predictions file has /samples/id (N) and /samples/predicted (N, V, 3)";

/// Appends a defect unless the dataset is there and its type begins with `prefix`.
void check_type(const Hdf5File& file, const char* dataset, const char* prefix, const char* what,
                std::vector<StructureDefect>& defect) {
    if (!file.is_dataset(dataset)) {
        defect.push_back({dataset, "missing"});
        return;
    }
    const std::string type = file.type_name(dataset);
    if (!type.starts_with(prefix) && !type.starts_with(std::string("u") + prefix))
        defect.push_back({dataset, "holds " + type + ", expected " + what});
}

void check_shapes(const Shape& id, const Shape& predicted, std::vector<StructureDefect>& defect) {
    if (id.size() != 1) defect.push_back({id_name, "has shape " + shape_text(id) + ", expected (N)"});
    if (predicted.size() != 3 || predicted[2] != 3)
        defect.push_back({predicted_name, "has shape " + shape_text(predicted) + ", expected (N, V, 3)"});
    if (defect.empty() && id[0] != predicted[0])
        defect.push_back({predicted_name,
                          "holds " + std::to_string(predicted[0]) + " samples for " + std::to_string(id[0]) + " ids"});
}

/// Names go into tables, paths of HDF5 groups and file names.
void check_name(const std::string& name, const std::string& path) {
    const auto strange = [](unsigned char one) { return one < ' ' || one == 0x7f || one == '/'; };
    if (name.size() > 100 || name.starts_with('.') || std::any_of(name.begin(), name.end(), strange))
        throw Error("the predictor's name is too long, begins with a dot, or has a slash or a control character in it",
                    path + ":predictor", "choose another for the attribute \"predictor\"");
}

std::string text_of(const Hdf5File& file, const char* key) {
    return file.has_attribute("/", key) ? file.string_attribute("/", key) : std::string();
}

PredictionsHeader read_header(const Hdf5File& file) {
    const bool ours = text_of(file, "format") == "toile";
    if (ours && file.integer_attribute("/", "version") != predictions_version)
        throw Error("the file has version " + std::to_string(file.integer_attribute("/", "version")) +
                        ", and this program reads version " + std::to_string(predictions_version),
                    file.path());
    PredictionsHeader header;
    header.predictor = text_of(file, "predictor");
    header.options = text_of(file, "options");
    header.dataset_config_hash = text_of(file, "dataset_config_hash");
    header.program_version = text_of(file, "program_version");
    if (header.predictor.empty()) header.predictor = std::filesystem::path(file.path()).stem().string();
    check_name(header.predictor, file.path());
    return header;
}

}  // namespace

struct PredictionsWriter::Impl {
    Impl(const std::string& path, int64_t count, int vertex_count)
        : sample_count(count), vertices(vertex_count), target(path), file(Hdf5File::create(target.partial())) {}

    const int64_t sample_count, vertices;
    NewFile target;
    Hdf5File file;
    int64_t next = 0;
};

PredictionsWriter::PredictionsWriter(const std::string& path, const PredictionsHeader& header, int64_t sample_count,
                                     int vertex_count) {
    if (sample_count < 1 || vertex_count < 1) throw Error("there is nothing to predict", path);
    impl_ = std::make_unique<Impl>(path, sample_count, vertex_count);
    Hdf5File& file = impl_->file;
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", predictions_version);
    file.set_attribute("/", "program_version", header.program_version);
    file.set_attribute("/", "predictor", header.predictor);
    file.set_attribute("/", "options", header.options);
    file.set_attribute("/", "dataset_config_hash", header.dataset_config_hash);
    file.create_rows<int64_t>(id_name, sample_count, {}, 0);
    file.create_rows<float>(predicted_name, sample_count, {impl_->vertices, 3}, 0);
}

PredictionsWriter::~PredictionsWriter() = default;

void PredictionsWriter::write(std::span<const int64_t> id, std::span<const float> predicted) {
    const auto count = static_cast<int64_t>(id.size());
    if (impl_->next + count > impl_->sample_count)
        throw Error("there is no sample " + std::to_string(impl_->sample_count) + " to write", impl_->target.path());
    const int64_t expected = count * impl_->vertices * 3;
    if (static_cast<int64_t>(predicted.size()) != expected)
        throw Error(std::string(predicted_name) + " got " + std::to_string(predicted.size()) + " values, not " +
                        std::to_string(expected),
                    impl_->target.path());
    if (count == 0) return;
    impl_->file.write_rows(id_name, impl_->next, count, id.data());
    impl_->file.write_rows(predicted_name, impl_->next, count, predicted.data());
    impl_->next += count;
}

void PredictionsWriter::finish() {
    if (impl_->next != impl_->sample_count)
        throw Error("sample " + std::to_string(impl_->next) + " of " + std::to_string(impl_->sample_count) +
                        " was never written",
                    impl_->target.path());
    impl_->file.close();
    impl_->target.commit();
}

std::vector<StructureDefect> predictions_structure_defects(const Hdf5File& file) {
    std::vector<StructureDefect> defect;
    check_type(file, id_name, "int", "integers", defect);
    check_type(file, predicted_name, "float", "floating point", defect);
    if (defect.empty()) check_shapes(file.shape(id_name), file.shape(predicted_name), defect);
    return defect;
}

std::vector<std::pair<int64_t, int64_t>> sorted_ids(const std::vector<int64_t>& id) {
    std::vector<std::pair<int64_t, int64_t>> sorted;
    sorted.reserve(id.size());
    for (size_t i = 0; i < id.size(); ++i) sorted.emplace_back(id[i], static_cast<int64_t>(i));
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

PredictionsReader::PredictionsReader(const std::string& path) : file_(Hdf5File::open(path)) {
    const std::vector<StructureDefect> defect = predictions_structure_defects(file_);
    if (!defect.empty())
        throw Error(defect[0].dataset + " " + (defect[0].what == "missing" ? "is missing" : defect[0].what),
                    path + ":" + defect[0].dataset, layout_mend);
    header_ = read_header(file_);
    vertex_count_ =
        static_cast<int>(std::min<int64_t>(file_.shape(predicted_name)[1], std::numeric_limits<int>::max()));
    id_ = file_.read<int64_t>(id_name).value;
    sorted_ = sorted_ids(id_);
    const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
    const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end(), same);
    if (twice != sorted_.end())
        throw Error("sample " + std::to_string(twice->first) + " is predicted twice, at " +
                        std::to_string(twice->second) + " and " + std::to_string((twice + 1)->second),
                    path + ":" + id_name, "predict each sample once");
}

std::optional<int64_t> PredictionsReader::slot_of(int64_t id) const {
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair<int64_t, int64_t>(id, 0));
    if (at == sorted_.end() || at->first != id) return std::nullopt;
    return at->second;
}

Positions PredictionsReader::read(int64_t id) const {
    const std::vector<double> value = read(std::span(&id, 1));
    return Eigen::Map<const Positions>(value.data(), vertex_count_, 3);
}

std::vector<double> PredictionsReader::read(std::span<const int64_t> id) const {
    std::vector<double> value;
    value.reserve(id.size() * static_cast<size_t>(vertex_count_) * 3);
    for (const int64_t one : id) {
        const std::optional<int64_t> slot = slot_of(one);
        if (!slot) throw Error("sample " + std::to_string(one) + " is not predicted", path() + ":" + id_name);
        const std::vector<double> row = file_.read_rows<double>(predicted_name, *slot, 1).value;
        value.insert(value.end(), row.begin(), row.end());
    }
    return value;
}

}  // namespace toile::files

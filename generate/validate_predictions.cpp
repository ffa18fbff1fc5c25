#include "generate/validate_predictions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth/error.h"

namespace toile::generate {
namespace {

constexpr const char* id_name = "/samples/id";
constexpr const char* predicted_name = "/samples/predicted";

bool is_type(const files::Hdf5File& file, const char* dataset, const char* prefix, const char* what,
             std::vector<std::string>& defect) {
    if (!file.is_dataset(dataset)) {
        defect.push_back(std::string(dataset) + ": missing");
        return false;
    }
    const std::string type = file.type_name(dataset);
    if (type.starts_with(prefix) || type.starts_with(std::string("u") + prefix)) return true;
    defect.push_back(std::string(dataset) + ": holds " + type + ", expected " + what);
    return false;
}

bool check_shapes(const files::Shape& id, const files::Shape& predicted, std::vector<std::string>& defect) {
    const size_t before = defect.size();
    if (id.size() != 1)
        defect.push_back(std::string(id_name) + ": has shape " + files::shape_text(id) + ", expected (N)");
    if (predicted.size() != 3 || predicted[2] != 3)
        defect.push_back(std::string(predicted_name) + ": has shape " + files::shape_text(predicted) +
                         ", expected (N, V, 3)");
    if (defect.size() == before && id[0] != predicted[0])
        defect.push_back(std::string(predicted_name) + ": holds " + std::to_string(predicted[0]) + " samples for " +
                         std::to_string(id[0]) + " ids");
    return defect.size() == before;
}

/// Ids with their slots, in the ids' order.
std::vector<std::pair<int64_t, int64_t>> sorted_ids(const std::vector<int64_t>& id) {
    std::vector<std::pair<int64_t, int64_t>> sorted;
    for (size_t i = 0; i < id.size(); ++i) sorted.emplace_back(id[i], static_cast<int64_t>(i));
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

void check_ids(const std::vector<int64_t>& id, std::vector<std::string>& defect) {
    const auto sorted = sorted_ids(id);
    for (size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i].first == sorted[i - 1].first)
            defect.push_back(std::string(id_name) + "[" + std::to_string(sorted[i].second) +
                             "]: " + std::to_string(sorted[i].first) + " is the id of sample " +
                             std::to_string(sorted[i - 1].second) + " too");
}

void check_against(const std::string& dataset, const std::vector<int64_t>& id, int64_t vertices,
                   std::vector<std::string>& defect) {
    const files::Hdf5File file = files::Hdf5File::open(dataset);
    const int64_t theirs = file.shape("/samples/cloth").at(1);
    if (theirs != vertices)
        defect.push_back(std::string(predicted_name) + ": has " + std::to_string(vertices) +
                         " vertices, the data set " + std::to_string(theirs));
    std::vector<int64_t> known = file.read<int64_t>(id_name, {files::any_size}).value;
    std::sort(known.begin(), known.end());
    for (size_t i = 0; i < id.size(); ++i)
        if (!std::binary_search(known.begin(), known.end(), id[i]))
            defect.push_back(std::string(id_name) + "[" + std::to_string(i) + "]: " + std::to_string(id[i]) +
                             " is no sample of " + dataset);
}

void check_finite(const files::Hdf5File& file, int64_t slot, Validation& result) {
    const std::vector<double> value = file.read_rows<double>(predicted_name, slot, 1).value;
    const auto bad = [](double one) { return !std::isfinite(one); };
    const auto first = std::find_if(value.begin(), value.end(), bad);
    if (first == value.end()) {
        ++result.accepted;
        return;
    }
    const auto more = std::count_if(first + 1, value.end(), bad);
    result.defect.push_back(std::string(predicted_name) + "[" + std::to_string(slot) + "]: vertex " +
                            std::to_string((first - value.begin()) / 3) + " is not finite" +
                            (more > 0 ? ", and " + std::to_string(more) + " more numbers" : ""));
}

}  // namespace

bool is_predictions(const files::Hdf5File& file) {
    return file.has(predicted_name) && !file.has("/mesh") && !file.has("/samples/cloth");
}

Validation validate_predictions(const std::string& path, const ValidateOptions& options) {
    Validation result;
    const files::Hdf5File file = files::Hdf5File::open(path);
    bool sound = is_type(file, id_name, "int", "integers", result.defect);
    sound &= is_type(file, predicted_name, "float", "floating point", result.defect);
    if (!sound || !check_shapes(file.shape(id_name), file.shape(predicted_name), result.defect)) return result;
    try {
        const std::vector<int64_t> id = file.read<int64_t>(id_name).value;
        result.samples = static_cast<int>(id.size());
        check_ids(id, result.defect);
        for (int slot = 0; slot < result.samples; ++slot) {
            check_finite(file, slot, result);
            if (options.step) options.step(slot + 1, result.samples);
        }
        if (!options.dataset.empty()) check_against(options.dataset, id, file.shape(predicted_name)[1], result.defect);
    } catch (const Error& error) {  // a chunk that cannot be read
        result.defect.push_back(error.what() + (error.where().empty() ? "" : " (" + error.where() + ")"));
    }
    return result;
}

}  // namespace toile::generate

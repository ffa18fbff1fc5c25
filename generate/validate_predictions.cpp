#include "generate/validate_predictions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth/error.h"
#include "files/predictions_file.h"

namespace toile::generate {
namespace {

constexpr const char* id_name = "/samples/id";
constexpr const char* predicted_name = "/samples/predicted";

void check_ids(const std::vector<int64_t>& id, std::vector<std::string>& defect) {
    const auto sorted = files::sorted_ids(id);
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
    for (const files::StructureDefect& one : files::predictions_structure_defects(file))
        result.defect.push_back(one.dataset + ": " + one.what);
    if (!result.defect.empty()) return result;
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

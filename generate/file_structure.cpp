#include "generate/file_structure.h"

#include <cctype>
#include <sstream>
#include <utility>

#include "cloth/error.h"

namespace toile::generate {
namespace {

/// The size each letter stands for, with the dataset that said so first.
using Sizes = std::map<std::string, std::pair<int64_t, std::string>>;

void check_shape(const Field& field, const files::Shape& shape, Sizes& sizes, std::vector<std::string>& defect) {
    std::istringstream text(field.size);
    std::vector<std::string> expected;
    for (std::string word; text >> word;) expected.push_back(word);
    if (expected.size() != shape.size()) {
        defect.push_back(std::string(field.name) + ": has shape " + files::shape_text(shape) + ", expected " +
                         std::to_string(expected.size()) + " dimensions");
        return;
    }
    for (size_t i = 0; i < shape.size(); ++i) {
        int64_t size = shape[i];
        std::string source;
        if (std::isdigit(static_cast<unsigned char>(expected[i][0]))) {
            size = std::stoll(expected[i]);
        } else {
            std::tie(size, source) = sizes.try_emplace(expected[i], shape[i], field.name).first->second;
        }
        if (size != shape[i])
            defect.push_back(std::string(field.name) + ": has shape " + files::shape_text(shape) + ", expected " +
                             std::to_string(size) + " along dimension " + std::to_string(i) +
                             (source.empty() ? "" : " as in " + source));
    }
}

void check_field(const files::Hdf5File& file, const Field& field, Sizes& sizes, std::vector<std::string>& defect) {
    try {
        if (!file.is_dataset(field.name)) {
            defect.push_back(std::string(field.name) + ": missing");
            return;
        }
        const std::string type = file.type_name(field.name);
        if (type != field.type)
            defect.push_back(std::string(field.name) + ": holds " + type + ", expected " + field.type);
        check_shape(field, file.shape(field.name), sizes, defect);
    } catch (const Error& error) {
        defect.push_back(std::string(field.name) + ": " + error.what());
    }
}

bool present(const files::Hdf5File& file, const Feature& feature) {
    bool any = feature.required || file.has(std::string("/") + feature.name);
    for (const Field& field : feature.field) any = any || file.has(field.name);
    return any;
}

}  // namespace

std::map<std::string, int64_t> check_structure(const files::Hdf5File& file, const std::vector<Feature>& table,
                                               std::vector<std::string>& defect) {
    Sizes sizes;
    for (const Feature& feature : table) {
        if (!present(file, feature)) continue;
        for (const Field& field : feature.field) check_field(file, field, sizes, defect);
    }
    std::map<std::string, int64_t> size;
    for (const auto& [letter, found] : sizes) size[letter] = found.first;
    return size;
}

}  // namespace toile::generate

#include "generate/dataset_structure.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "cloth/error.h"

namespace toile::generate {
namespace {

/// One line of the contract's table. `size` lists numbers and letters; a letter stands for one size in the whole file.
struct Field {
    const char* name;
    const char* type;
    const char* size;
};

/// Datasets that are there together or not at all.
struct Feature {
    const char* name;
    bool required;
    std::vector<Field> field;
};

const std::vector<Feature>& contract() {
    static const std::vector<Feature> feature{{"mesh",
                                               true,
                                               {{"/mesh/triangle", "int32", "F 3"},
                                                {"/mesh/rest_position", "float64", "V 3"},
                                                {"/mesh/pattern_position", "float64", "P 2"},
                                                {"/mesh/pattern_triangle", "int32", "F 3"}}},
                                              {"mass", false, {{"/mesh/mass", "float64", "V"}}},
                                              {"samples",
                                               true,
                                               {{"/samples/id", "int64", "N"},
                                                {"/samples/split", "int8", "N"},
                                                {"/samples/status", "int8", "N"},
                                                {"/samples/cloth", "float32", "N V 3"},
                                                {"/samples/digest", "uint8", "N 16"}}},
                                              {"certificate",
                                               true,
                                               {{"/certificate/residual_force", "float64", "N"},
                                                {"/certificate/body_penetration", "float64", "N"},
                                                {"/certificate/self_intersections", "int32", "N"},
                                                {"/certificate/max_stretch", "float64", "N"},
                                                {"/certificate/min_stretch", "float64", "N"},
                                                {"/certificate/max_speed", "float64", "N"},
                                                {"/certificate/seconds", "float64", "N"}}},
                                              {"body",
                                               false,
                                               {{"/body/triangle", "int32", "B 3"},
                                                {"/body/rest_position", "float64", "S 3"},
                                                {"/body/joint_name", "string", "J"},
                                                {"/body/joint_parent", "int32", "J"},
                                                {"/body/joint_bind", "float64", "J 4 4"},
                                                {"/body/weight_vertex", "int32", "W"},
                                                {"/body/weight_joint", "int32", "W"},
                                                {"/body/weight_value", "float64", "W"},
                                                {"/samples/pose", "float64", "N J 3"}}},
                                              {"embedding",
                                               false,
                                               {{"/embedding/triangle", "int32", "V"},
                                                {"/embedding/barycentric", "float64", "V 3"},
                                                {"/samples/embedded", "float32", "N V 3"},
                                                {"/samples/displacement", "float32", "N V 3"},
                                                {"/samples/frame", "float32", "N V 4"}}},
                                              {"image",
                                               false,
                                               {{"/image/pattern_pixel", "float64", "P 3"},
                                                {"/image/mask", "uint8", "L H H"},
                                                {"/samples/image", "float32", "N C H H"}}}};
    return feature;
}

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

/// The wall times are in a file of their own: a data set that was moved without it is still sound.
bool timing_stayed_behind(const files::Hdf5File& file, const std::string& name) {
    const std::vector<std::string> key = file.members("/certificate");
    const bool linked = std::find(key.begin(), key.end(), "seconds") != key.end();
    return name == "/certificate/seconds" && linked && !file.has(name);
}

void check_field(const files::Hdf5File& file, const Field& field, Sizes& sizes, std::vector<std::string>& defect) {
    try {
        if (timing_stayed_behind(file, field.name)) return;
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

void check_attributes(const files::Hdf5File& file, bool with_image, std::vector<std::string>& defect) {
    auto need = [&](const std::string& object, const auto& read) {
        try {
            read();
        } catch (const Error& error) {
            defect.push_back(object + ": " + error.what());
        }
    };
    for (const char* key : {"config", "config_hash", "program_version"})
        need("/", [&] { file.string_attribute("/", key); });
    need("/", [&] { file.integer_attribute("/", "seed"); });
    need("/samples/status", [&] { file.strings_attribute("/samples/status", "reasons"); });
    need("/samples/split", [&] { file.number_attribute("/samples/split", "duplicate_angle"); });
    if (!with_image) return;
    need("/samples/image", [&] {
        if (file.numbers_attribute("/samples/image", "resampling_error").size() != 2)
            throw Error("resampling_error does not hold two numbers");
    });
}

}  // namespace

std::vector<std::string> structure_defects(const files::Hdf5File& file) {
    std::vector<std::string> defect;
    Sizes sizes;
    for (const Feature& feature : contract()) {
        if (!present(file, feature)) continue;
        for (const Field& field : feature.field) check_field(file, field, sizes, defect);
    }
    if (sizes.count("C") && sizes.count("L") && sizes["C"].first != 3 * sizes["L"].first)
        defect.push_back("/samples/image: has " + std::to_string(sizes["C"].first) + " channels for " +
                         std::to_string(sizes["L"].first) + " layers in /image/mask");
    if (file.has("/embedding") && !file.has("/body")) defect.push_back("/embedding: there is no /body to carry it");
    if (file.has("/image") && !file.has("/embedding")) defect.push_back("/image: there is no /embedding it could show");
    check_attributes(file, file.has("/samples/image"), defect);
    return defect;
}

}  // namespace toile::generate

#include "generate/dataset_structure.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "cloth/error.h"
#include "generate/file_structure.h"

namespace toile::generate {
namespace {

constexpr std::string_view timing_name = "/certificate/seconds";

const std::vector<Feature>& contract() {
    static const std::vector<Feature> feature{
        {"mesh",
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
        {"certificate in detail",
         false,
         {{"/certificate/moving_share", "float64", "N"},
          {"/certificate/body_crossings", "int32", "N"},
          {"/certificate/iterations", "int32", "N"},
          {"/certificate/path_steps", "int32", "N"},
          {"/certificate/tries", "int32", "N"},
          {"/certificate/rung", "int32", "N"}}},
        {"what came of each rung",
         false,
         {{"/certificate/rung_0_status", "int32", "N"},
          {"/certificate/rung_1_status", "int32", "N"},
          {"/certificate/rung_2_status", "int32", "N"},
          {"/certificate/rung_3_status", "int32", "N"},
          {"/certificate/rung_0_residual_force", "float64", "N"},
          {"/certificate/rung_1_residual_force", "float64", "N"},
          {"/certificate/rung_2_residual_force", "float64", "N"},
          {"/certificate/rung_3_residual_force", "float64", "N"}}},
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
          {"/samples/image", "float32", "N C H H"}}},
        {"the error of each sample's image", false, {{"/samples/resampling_error", "float64", "N 2"}}}};
    return feature;
}

/// The wall times are in a file of their own: a data set that was moved without it is still sound.
bool timing_stayed_behind(const files::Hdf5File& file) {
    const std::vector<std::string> key = file.members("/certificate");
    const bool linked = std::find(key.begin(), key.end(), "seconds") != key.end();
    return linked && !file.has(std::string(timing_name));
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

/// A merged data set lies in the parts it refers to.
void check_parts(const files::Hdf5File& file, std::vector<std::string>& defect) {
    std::set<std::string> lines;
    for (const std::string& name : file.members("/samples"))
        if (file.is_dataset("/samples/" + name))
            for (const std::string& line : file.unreadable_parts("/samples/" + name)) lines.insert(line);
    for (const std::string& line : lines)
        defect.push_back("/samples: " + line + "; put it back where it was, or run toile merge again");
}

}  // namespace

std::vector<std::string> structure_defects(const files::Hdf5File& file) {
    std::vector<std::string> defect;
    std::vector<Feature> table = contract();
    if (timing_stayed_behind(file)) {
        for (Feature& feature : table)
            std::erase_if(feature.field, [](const Field& field) { return field.name == timing_name; });
    }
    std::map<std::string, int64_t> size = check_structure(file, table, defect);
    if (size.count("C") && size.count("L") && size["C"] != 3 * size["L"])
        defect.push_back("/samples/image: has " + std::to_string(size["C"]) + " channels for " +
                         std::to_string(size["L"]) + " layers in /image/mask");
    if (file.has("/embedding") && !file.has("/body")) defect.push_back("/embedding: there is no /body to carry it");
    if (file.has("/image") && !file.has("/embedding")) defect.push_back("/image: there is no /embedding it could show");
    check_attributes(file, file.has("/samples/image"), defect);
    check_parts(file, defect);
    return defect;
}

}  // namespace toile::generate

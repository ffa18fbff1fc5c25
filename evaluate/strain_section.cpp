#include "evaluate/strain_section.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "cloth/error.h"
#include "files/metric_file.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;
constexpr size_t most_frames = 50;

double real(const Json& from, const char* key) {
    const Json& value = from.at(key);
    return value.is_null() ? not_there : value.get<double>();
}

const Json* quantity(const Json& document, const std::string& name) {
    for (const Json& one : document.at("quantity"))
        if (one.at("name") == name) return &one;
    return nullptr;
}

ReportHistogram histogram(const Json& document, const std::string& id, const std::string& title, const ReportAxis& axis,
                          const std::vector<std::pair<const char*, const char*>>& series) {
    ReportHistogram out{id, title, "The outer bins hold what lies beyond them: a thousandth at each end.", axis, {}};
    for (const auto& [name, label] : series) {
        const Json* one = quantity(document, name);
        if (!one || one->at("histogram").at("edges").empty()) continue;
        out.series.push_back({label, one->at("histogram").at("edges").get<std::vector<double>>(),
                              one->at("histogram").at("counts").get<std::vector<double>>()});
    }
    return out;
}

ReportTable quantity_table(const Json& document) {
    using Align = ReportColumn::Align;
    ReportTable table{"strain-quantities",
                      "Strain over all frames",
                      "Principal stretches are ratios of lengths, stretch_1 the largest. Triangles: from edge vectors. "
                      "Vertices: best fit over the neighbourhood; surface stretches lie in the tangent plane.",
                      {{"quantity", "", Align::text},
                       {"unit", "", Align::text},
                       {"smallest", "", Align::number, 5},
                       {"1 %", "", Align::number, 5},
                       {"median", "", Align::number, 5},
                       {"95 %", "", Align::number, 5},
                       {"99 %", "", Align::number, 5},
                       {"largest", "", Align::number, 5}}};
    for (const Json& one : document.at("quantity"))
        table.rows.push_back({one.at("name").get<std::string>(), one.at("unit").get<std::string>(),
                              real(one, "smallest"), real(one, "p1"), real(one, "median"), real(one, "p95"),
                              real(one, "p99"), real(one, "largest")});
    return table;
}

ReportTable fault_table(const Json& document) {
    using Align = ReportColumn::Align;
    ReportTable table{"strain-faults",
                      "Triangles and vertices without (all) values",
                      "Counted over all frames. Collapsed and inverted ones have stretches; the others have no values.",
                      {{"fault", "", Align::text}, {"triangles", ""}, {"vertices", ""}}};
    const Json &triangle = document.at("faults").at("triangle"), &vertex = document.at("faults").at("vertex");
    for (const auto& [name, count] : triangle.items())
        if (count.get<double>() + vertex.at(name).get<double>() > 0)
            table.rows.push_back({name, count.get<double>(), vertex.at(name).get<double>()});
    return table;
}

double sum_of(const Json& faults) {
    double sum = 0;
    for (const auto& [name, count] : faults.items()) sum += count.get<double>();
    return sum;
}

/// The frames with the largest stretches, in their order.
std::vector<size_t> chosen_frames(const Json& frames) {
    std::vector<size_t> index(frames.size());
    std::iota(index.begin(), index.end(), size_t{0});
    if (index.size() <= most_frames) return index;
    std::stable_sort(index.begin(), index.end(), [&](size_t a, size_t b) {
        const auto largest = [&](size_t k) {
            const Json& value = frames[k].at("triangle").at("stretch_1").at("largest");
            return value.is_null() ? 0.0 : value.get<double>();
        };
        return largest(a) > largest(b);
    });
    index.resize(most_frames);
    std::sort(index.begin(), index.end());
    return index;
}

ReportTable frame_table(const Json& document) {
    using Align = ReportColumn::Align;
    const Json& frames = document.at("frames");
    const bool rates = document.at("rates");
    ReportTable table{"strain-frames", "Frame by frame", "Of triangles.", {{"frame", "", Align::text}}};
    for (const char* name :
         {"stretch_1, median", "stretch_1, 99 %", "stretch_1, largest", "stretch_2, 1 %", "stretch_2, smallest"})
        table.columns.push_back({name, "", Align::number, 5});
    table.columns.push_back({"with a fault", ""});
    if (rates)
        for (const auto& [name, unit] : {std::pair("largest strain rate", "1/s"), std::pair("largest spin", "rad/s"),
                                         std::pair("the time step's error, largest", "1/s")})
            table.columns.push_back({name, unit});
    const std::vector<size_t> chosen = chosen_frames(frames);
    if (chosen.size() < frames.size())
        table.note =
            fmt::format("Of triangles; the {} of {} frames with the largest stretch.", chosen.size(), frames.size());
    for (const size_t k : chosen) {
        const Json &one = frames[k].at("triangle"), &first = one.at("stretch_1"), &second = one.at("stretch_2");
        const std::string name = frames[k].at("name");
        table.rows.push_back({std::filesystem::path(name).filename().string(), real(first, "median"),
                              real(first, "p99"), real(first, "largest"), real(second, "p1"), real(second, "smallest"),
                              sum_of(one.at("faults"))});
        if (!rates) continue;
        for (const char* key : {"largest_rate", "largest_spin", "largest_rate_error"})
            table.rows.back().emplace_back(real(one, key));
    }
    return table;
}

std::string about(const Json& document, const char* key) {
    return document.at("about").value(key, "");
}

std::vector<std::string> text_of(const Json& document) {
    const std::string source = about(document, document.at("about").contains("dataset") ? "dataset" : "frames");
    std::vector<std::string> text = {fmt::format(
        "Strain of {} frames of {} triangles and {} vertices ({}), measured from {}. Each triangle's deformation "
        "gradient F comes from its edges; F = R U gives the principal stretches: 1 is as at rest, 1.25 a quarter "
        "longer. Vertices: F fitted over {}; the residual is the share of the neighbourhood's shape that one F does "
        "not "
        "explain: where it is large, as in a fold, the fit follows the chord, and its stretches fall below those of "
        "the "
        "triangles.",
        document.at("frames").size(), document.at("triangles").get<int>(), document.at("vertices").get<int>(), source,
        about(document, "rest"), about(document, "neighbourhood"))};
    for (const Json& note : document.at("notes")) text.push_back(note.get<std::string>() + ".");
    return text;
}

ReportSection section_of(const Json& document) {
    ReportSection section{"strain", "Strain", text_of(document), {}};
    section.blocks.push_back(histogram(document, "strain-triangle-stretch", "Principal stretches of triangles",
                                       {"stretch", "1"},
                                       {{"triangle/stretch_1", "largest"}, {"triangle/stretch_2", "smallest"}}));
    section.blocks.push_back(
        histogram(document, "strain-vertex-stretch", "Principal stretches in the surface at vertices", {"stretch", "1"},
                  {{"vertex/surface_stretch_1", "largest"}, {"vertex/surface_stretch_2", "smallest"}}));
    if (document.at("rates").get<bool>())
        section.blocks.push_back(histogram(document, "strain-rates", "Principal strain rates of triangles",
                                           {"strain rate", "1/s"},
                                           {{"triangle/rate_1", "largest"}, {"triangle/rate_2", "smallest"}}));
    section.blocks.push_back(quantity_table(document));
    ReportTable faults = fault_table(document);
    if (faults.rows.empty())
        section.text.push_back("All triangles and vertices have values in all frames, and none is inverted.");
    else
        section.blocks.push_back(std::move(faults));
    section.blocks.push_back(frame_table(document));
    return section;
}

}  // namespace

std::optional<ReportSection> strain_section(const std::string& folder) {
    const std::string path = (std::filesystem::path(folder) / "strain.json").string();
    if (!std::filesystem::exists(path)) return std::nullopt;
    const Json document = files::read_metric_document(path, "strain");
    try {
        return section_of(document);
    } catch (const nlohmann::json::exception& failure) {
        throw Error(std::string("not what strain analysis leaves: ") + failure.what(), path,
                    "run toile evaluate strain again");
    }
}

}  // namespace toile::evaluate

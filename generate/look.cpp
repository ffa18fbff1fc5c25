#include "generate/look.h"

#include <cstdio>
#include <filesystem>
#include <optional>

#include "files/dataset_file.h"
#include "files/mesh_file.h"
#include "generate/contact_sheet.h"
#include "generate/stored_body.h"

namespace toile::generate {
namespace {

std::string numbered(int64_t id) {
    char text[32];
    std::snprintf(text, sizeof text, "pose_%04lld", static_cast<long long>(id));
    return text;
}

void write_scene(const std::string& path, const files::DatasetHeader& header, const std::optional<skin::Body>& body,
                 const files::SampleRecord& sample) {
    std::vector<files::NamedMesh> mesh;
    if (body && header.embedding)
        mesh.push_back({"body", body->triangle, posed_as_stored(header, *body, sample).position, skin_color});
    mesh.push_back({"cloth", header.mesh.triangle, sample.cloth, cloth_color});
    files::write_meshes(path, mesh);
}

std::string sheet_label(const files::DatasetHeader& header, const files::SampleRecord& sample) {
    std::string label = "pose " + std::to_string(sample.id);
    if (sample.status != 0) label += "\n" + header.reasons[sample.status];
    return label;
}

}  // namespace

std::vector<std::string> write_look(const std::string& dataset, const std::string& folder,
                                    const std::vector<int>& slots) {
    const files::DatasetReader reader(dataset);
    const files::DatasetHeader& header = reader.header();
    std::optional<skin::Body> body;
    if (header.body) body = skinned_body(*header.body);
    std::vector<std::string> written;
    std::vector<SheetRow> row;
    for (const int slot : slots) {
        if (slot < 0 || slot >= reader.sample_count()) continue;
        files::SampleRecord sample = reader.read(slot);
        if (!sample.cloth.allFinite() || !sample.pose.allFinite() || !sample.embedded.allFinite()) continue;
        written.push_back((std::filesystem::path(folder) / (numbered(sample.id) + ".glb")).string());
        write_scene(written.back(), header, body, sample);
        if (header.image) row.push_back({sheet_label(header, sample), std::move(sample.image)});
    }
    if (row.empty()) return written;
    written.push_back((std::filesystem::path(folder) / "displacements.png").string());
    files::write_png(written.back(), contact_sheet(*header.image, row));
    return written;
}

}  // namespace toile::generate

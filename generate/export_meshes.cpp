#include <cstdio>
#include <optional>

#include "files/mesh_file.h"
#include "files/new_folder.h"
#include "files/point_cache.h"
#include "generate/export_formats.h"

namespace toile::generate {
namespace {

std::string numbered(const char* mesh, int64_t id, const char* extension) {
    char text[64];
    std::snprintf(text, sizeof text, "%s_%06lld%s", mesh, static_cast<long long>(id), extension);
    return text;
}

files::NamedMesh cloth_mesh(const files::DatasetHeader& header, Positions position) {
    files::NamedMesh mesh{"cloth", header.mesh.triangle, std::move(position)};
    mesh.texture = header.mesh.pattern_position;
    mesh.texture_triangle = header.mesh.pattern_triangle;
    return mesh;
}

}  // namespace

std::vector<std::string> export_meshes(const ExportSamples& samples, const ExportOptions& options) {
    const char* extension = options.format == ExportFormat::obj ? ".obj" : ".ply";
    files::NewFolder folder(options.out);
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("writing meshes", k);
        const int64_t id = samples.entry()[k].id;
        files::write_meshes(folder.file(numbered("cloth", id, extension)),
                            {cloth_mesh(samples.header(), samples.cloth(k))});
        if (samples.body())
            files::write_meshes(folder.file(numbered("body", id, extension)),
                                {{"body", samples.body()->triangle, samples.body_position(k)}});
    }
    folder.commit();
    return {options.out};
}

std::vector<std::string> export_point_cache(const ExportSamples& samples, const ExportOptions& options) {
    files::NewFolder folder(options.out);
    const ClothMesh& mesh = samples.header().mesh;
    const std::optional<skin::Body>& body = samples.body();
    files::write_meshes(folder.file("cloth.obj"), {cloth_mesh(samples.header(), mesh.rest_position)});
    files::PointCacheWriter cloth_cache(folder.file("cloth.pc2"), mesh.vertex_count(), samples.count());
    std::optional<files::PointCacheWriter> body_cache;
    if (body) {
        files::write_meshes(folder.file("body.obj"), {{"body", body->triangle, body->rest_position}});
        body_cache.emplace(folder.file("body.pc2"), body->vertex_count(), samples.count());
    }
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("writing point caches", k);
        cloth_cache.append(samples.cloth(k));
        if (body) body_cache->append(samples.body_position(k));
    }
    cloth_cache.commit();
    if (body) body_cache->commit();
    folder.commit();
    return {options.out};
}

}  // namespace toile::generate

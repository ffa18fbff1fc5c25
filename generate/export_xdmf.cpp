#include <filesystem>
#include <optional>

#include "cloth/error.h"
#include "files/new_file.h"
#include "files/xdmf_file.h"
#include "generate/export_formats.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;

/// Enough to see what a corpus is like.
constexpr int64_t samples_beside_a_dataset = 200;

std::string body_path(const std::string& xdmf) {
    return fs::path(xdmf).replace_extension(".body.h5").string();
}

/// `file` as an XDMF file at `xdmf` refers to it.
std::string reference(const std::string& file, const std::string& xdmf) {
    const std::string relative =
        fs::proximate(fs::canonical(file), fs::weakly_canonical(fs::absolute(xdmf)).parent_path()).string();
    if (relative.find(':') != std::string::npos)
        throw Error("XDMF cannot refer to a file with a colon in its path", file, "rename it");
    return relative;
}

files::XdmfMesh cloth_in_dataset(const ExportSamples& samples, const std::string& file) {
    const files::DatasetHeader& header = samples.header();
    files::XdmfMesh mesh{"cloth", {file, "/mesh/triangle"}, {file, "/samples/cloth"}, {}, 0, 0, 0};
    if (header.embedding) mesh.attribute = {{"displacement", {file, "/samples/displacement"}}};
    mesh.triangles = header.mesh.triangle_count();
    mesh.vertices = header.mesh.vertex_count();
    mesh.rows = samples.dataset_count();
    return mesh;
}

/// The posed body, which a data set does not hold: sample k of the export is row k.
struct BodyFile {
    BodyFile(const std::string& path, const ExportSamples& samples) : file(path) {
        const skin::Body& body = *samples.body();
        files::Hdf5File data = files::Hdf5File::create(file.partial());
        data.set_attribute("/", "format", "toile body");
        data.set_attribute("/", "config_hash", samples.header().config_hash);
        std::vector<int64_t> id;
        for (const ExportSamples::Entry& entry : samples.entry()) id.push_back(entry.id);
        data.write("/samples/id", id, {samples.count()});
        data.write("/body/triangle", body.triangle.data(), {body.triangle.rows(), 3});
        data.create_rows<float>("/body/position", samples.count(), {body.vertex_count(), 3}, 1);
        for (int k = 0; k < samples.count(); ++k) {
            samples.step("writing the body", k);
            const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> value =
                samples.body_position(k).cast<float>();
            data.write_row("/body/position", k, value.data());
        }
        data.close();
    }
    files::NewFile file;
};

files::XdmfMesh body_in_file(const ExportSamples& samples, const std::string& file) {
    files::XdmfMesh mesh{"body", {file, "/body/triangle"}, {file, "/body/position"}, {}, 0, 0, 0};
    mesh.triangles = samples.body()->triangle.rows();
    mesh.vertices = samples.body()->vertex_count();
    mesh.rows = samples.count();
    return mesh;
}

}  // namespace

std::vector<std::string> export_xdmf(const ExportSamples& samples, const ExportOptions& options) {
    const std::string beside = body_path(options.out);
    if (fs::weakly_canonical(beside) == fs::weakly_canonical(options.dataset))
        throw Error("the body's positions would replace the data set", options.dataset, "choose another --out");
    const files::XdmfMesh cloth = cloth_in_dataset(samples, reference(options.dataset, options.out));
    files::XdmfWriter file(options.out);
    std::optional<BodyFile> body;
    files::XdmfMesh body_mesh;
    if (samples.body()) {
        body.emplace(beside, samples);
        body_mesh = body_in_file(samples, fs::path(beside).filename().string());
    }
    for (int k = 0; k < samples.count(); ++k) {
        const ExportSamples::Entry& entry = samples.entry()[k];
        file.begin_sample("pose_" + std::to_string(entry.id), entry.id);
        file.add_mesh(cloth, entry.slot, {{"pose", entry.id}, {"split", entry.split}, {"status", entry.status}});
        if (body) file.add_mesh(body_mesh, k, {});
        file.end_sample();
    }
    file.commit();
    if (!body) return {options.out};
    body->file.commit();
    return {options.out, beside};
}

void write_xdmf(const std::string& dataset) {
    ExportOptions options;
    options.dataset = dataset;
    options.out = fs::path(dataset).replace_extension(".xdmf").string();
    options.format = ExportFormat::xdmf;
    options.failed = true;
    options.at_most = samples_beside_a_dataset;
    const ExportSamples samples(options);
    if (samples.count() > 0) export_xdmf(samples, options);
}

}  // namespace toile::generate

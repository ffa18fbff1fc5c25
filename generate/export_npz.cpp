#include "files/npz_file.h"
#include "generate/export_formats.h"

namespace toile::generate {
namespace {

std::vector<int32_t> indices(const Triangles& triangle) {
    return {triangle.data(), triangle.data() + triangle.size()};
}

template <typename Rows>
std::vector<double> numbers(const Rows& rows) {
    return {rows.data(), rows.data() + rows.size()};
}

void append_positions(files::NpzWriter& file, const Positions& position) {
    const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> value = position.cast<float>();
    file.append(value.data(), sizeof(float) * static_cast<size_t>(value.size()));
}

void add_columns(files::NpzWriter& file, const ExportSamples& samples) {
    std::vector<int64_t> id;
    std::vector<int8_t> split, status;
    for (const ExportSamples::Entry& entry : samples.entry()) {
        id.push_back(entry.id);
        split.push_back(static_cast<int8_t>(entry.split));
        status.push_back(static_cast<int8_t>(entry.status));
    }
    const int64_t count = samples.count();
    file.add("id", id, {count});
    file.add("split", split, {count});
    file.add("status", status, {count});
    file.add_strings("reasons", samples.header().reasons);
    file.add_strings("config_hash", {samples.header().config_hash});
}

void add_cloth(files::NpzWriter& file, const ExportSamples& samples) {
    const ClothMesh& mesh = samples.header().mesh;
    file.begin("vertices_seq", "<f4", {samples.count(), mesh.vertex_count(), 3});
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("writing the cloth", k);
        append_positions(file, samples.cloth(k));
    }
    file.add("faces", indices(mesh.triangle), {mesh.triangle.rows(), 3});
    file.add("uv", numbers(mesh.pattern_position), {mesh.pattern_position.rows(), 2});
    file.add("uv_faces", indices(mesh.pattern_triangle), {mesh.pattern_triangle.rows(), 3});
}

/// AMASS's names for the motion: poses, trans, mocap_framerate.
void add_motion(files::NpzWriter& file, const ExportSamples& samples, double rate) {
    const int64_t count = samples.count(), joints = samples.body()->joint_count();
    file.begin("poses", "<f8", {count, 3 * joints});
    for (int k = 0; k < samples.count(); ++k) {
        const Positions pose = samples.pose(k);
        file.append(pose.data(), sizeof(double) * static_cast<size_t>(pose.size()));
    }
    file.add("trans", std::vector<double>(static_cast<size_t>(3 * count), 0.0), {count, 3});
    file.add("mocap_framerate", std::vector<double>{rate}, {});
    std::vector<std::string> name;
    std::vector<int32_t> parent;
    for (const skin::Joint& joint : samples.body()->joint) {
        name.push_back(joint.name);
        parent.push_back(joint.parent);
    }
    file.add_strings("joint_names", name);
    file.add("joint_parents", parent, {joints});
}

void add_body(files::NpzWriter& file, const ExportSamples& samples) {
    const skin::Body& body = *samples.body();
    file.begin("body_vertices_seq", "<f4", {samples.count(), body.vertex_count(), 3});
    for (int k = 0; k < samples.count(); ++k) {
        samples.step("writing the body", k);
        append_positions(file, samples.body_position(k));
    }
    file.add("body_faces", indices(body.triangle), {body.triangle.rows(), 3});
}

}  // namespace

std::vector<std::string> export_npz(const ExportSamples& samples, const ExportOptions& options) {
    files::NpzWriter file(options.out);
    add_columns(file, samples);
    if (samples.body()) add_motion(file, samples, options.rate);
    add_cloth(file, samples);
    if (samples.body()) add_body(file, samples);
    file.commit();
    return {options.out};
}

}  // namespace toile::generate

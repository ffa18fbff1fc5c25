// Writes the seeds that are not text into the folders below the one named on the command line (tests/fuzz/seeds).

#include <filesystem>

#include "files/journal.h"
#include "files/mesh_file.h"
#include "files/noise_file.h"
#include "files/plan_file.h"
#include "files/projection_file.h"
#include "files/replay_file.h"
#include "files/sample_bytes.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile {
namespace {

using test::header_of;
using test::sample_of;

void write_dataset(const std::string& path, bool with_body, bool with_image) {
    const files::DatasetHeader header = header_of(with_body, with_image);
    files::DatasetWriter writer(path, header, 2, 4);
    for (int slot = 0; slot < 2; ++slot) writer.write(slot, sample_of(header, slot));
    writer.finish();
}

void write_problem(const std::string& path) {
    const ClothMesh mesh = header_of(false, false).mesh;
    files::Hdf5File file = files::Hdf5File::create(path);
    file.write("/mesh/triangle", mesh.triangle.data(), {1, 3});
    file.write("/mesh/rest_position", mesh.rest_position.data(), {3, 3});
    file.write("/samples/predicted", mesh.rest_position.data(), {1, 3, 3});
    file.write("/samples/target", mesh.rest_position.data(), {1, 3, 3});
    file.close();
}

void write_projection(const std::string& path) {
    files::ProjectionHeader header;
    header.mesh = header_of(false, false).mesh;
    header.limits.emplace();
    header.limits->edge.resize(3, 2);
    header.limits->edge << 0, 1, 0, 2, 1, 2;
    header.limits->edge_max_length = Eigen::Vector3d(1, 1, std::sqrt(2.0));
    header.target_stiffness = header.mesh.mass;
    header.tolerance = 1e-6;
    header.config_hash = "0123456789abcdef0123456789abcdef";
    const std::vector<double> position(header.mesh.rest_position.data(), header.mesh.rest_position.data() + 9);
    const std::vector<double> multiplier(3, 0.0);
    files::ProjectionRows rows;
    rows.predicted = rows.projected = position;
    rows.status = {0};
    rows.iterations = {3};
    rows.seconds = rows.residual = {1e-7};
    rows.multiplier = multiplier;
    files::ProjectionWriter writer(path, header, 1);
    writer.write(rows);
    writer.finish();
}

void write_noise(const std::string& path) {
    const files::DatasetHeader dataset = header_of(false, false);
    files::NoiseHeader header;
    header.mesh = dataset.mesh;
    header.variant = {{"half_step", "half the time step"}};
    header.reasons = dataset.reasons;
    header.share = 0.5;
    const Eigen::VectorXd distance = Eigen::VectorXd::Constant(3, 1e-3);
    Positions other = header.mesh.rest_position;
    other.col(2).array() += 1e-3;
    files::NoiseWriter writer(path, header, 1);
    writer.write({7, 0, header.mesh.rest_position, {{0, other, distance}}, distance, 1e-3, 1e-3});
    writer.finish();
}

void write_replay(const std::string& path) {
    const files::DatasetHeader dataset = header_of(true, false);
    const files::SampleRecord sample = sample_of(dataset, 1);
    files::ReplayRecord record;
    record.config = dataset.config;
    record.reason = "not at rest";
    record.mesh = dataset.mesh;
    record.pose = sample.pose;
    record.start = record.cloth = sample.cloth;
    record.certificate = sample.certificate;
    record.tries = {{"finer steps", "not at rest", sample.certificate}};
    files::write_replay(path, record);
}

void write_journal(const std::string& path) {
    const files::DatasetHeader header = header_of(true, true);
    files::Journal journal(path);
    for (int slot = 0; slot < 2; ++slot) journal.append(files::sample_bytes(sample_of(header, slot)));
}

void write_all(const std::string& folder) {
    for (const char* reader : {"hdf5", "journal", "ply", "gltf"})
        std::filesystem::create_directories(folder + "/" + reader);
    write_dataset(folder + "/hdf5/dataset.h5", true, true);
    write_dataset(folder + "/hdf5/without_body.h5", false, false);
    write_problem(folder + "/hdf5/problem.h5");
    write_projection(folder + "/hdf5/projection.h5");
    write_noise(folder + "/hdf5/noise.h5");
    write_replay(folder + "/hdf5/replay.h5");
    files::write_plan(folder + "/hdf5/plan.h5", {header_of(true, true), {3, 8}, {0, 2}, {"made by hand"}});
    write_journal(folder + "/journal/two_samples");
    const ClothMesh mesh = header_of(false, false).mesh;
    files::write_mesh(folder + "/ply/binary.ply", mesh.triangle, mesh.rest_position);
    files::write_mesh(folder + "/gltf/triangle.glb", mesh.triangle, mesh.rest_position);
}

}  // namespace
}  // namespace toile

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    toile::write_all(argv[1]);
    return 0;
}

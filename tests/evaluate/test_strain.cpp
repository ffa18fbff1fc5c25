#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth/error.h"
#include "evaluate/strain.h"
#include "evaluate/strain_colour.h"
#include "evaluate/strain_frames.h"
#include "evaluate/strain_section.h"
#include "files/hdf5_file.h"
#include "files/mesh_file.h"
#include "files/mesh_frame.h"
#include "files/metric_file.h"
#include "tests/evaluate/strain_meshes.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::evaluate {
namespace {

using test::mapped;
using test::sheet;
using test::turn;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Strain : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_strain_" + std::to_string(::getpid()) + "_" +
                                               ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        files::write_mesh(path("rest.obj"), mesh_.triangle, mesh_.rest_position);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// Frame k of a sheet that spins by `spin` rad/s about z, and grows by exp(rate t) along x.
    Positions frame(int k, double step) const {
        const Eigen::Matrix3d grow = Eigen::Vector3d(std::exp(0.5 * k * step), 1, 1).asDiagonal();
        return mapped(mesh_.rest_position,
                      Eigen::AngleAxisd(2 * k * step, Eigen::Vector3d::UnitZ()).toRotationMatrix() * grow);
    }
    void write_sequence(int count, double step, const std::string& extension = ".ply") const {
        fs::create_directories(path("frames"));
        for (int k = 0; k < count; ++k)
            files::write_mesh(path("frames/f" + std::to_string(k) + extension), mesh_.triangle, frame(k, step));
    }
    StrainOptions options(const std::string& out = "out") const {
        StrainOptions options;
        options.rest = path("rest.obj");
        options.folder = path(out);
        return options;
    }
    std::string bytes(const std::string& name) const {
        std::ostringstream text;
        text << std::ifstream(path(name), std::ios::binary).rdbuf();
        return text.str();
    }
    std::string refusal(const StrainOptions& options) const {
        try {
            evaluate_strain(options);
        } catch (const Error& error) {
            return error.where() + " " + error.what();
        }
        return "accepted";
    }

    ClothMesh mesh_ = sheet(6);
    fs::path folder_;
};

TEST_F(Strain, MeasuresAPair) {
    const Eigen::Matrix3d stretch = Eigen::Vector3d(1.2, 0.9, 1).asDiagonal();
    files::write_mesh(path("a.obj"), mesh_.triangle, mapped(mesh_.rest_position, turn() * stretch));
    StrainOptions pair = options();
    pair.sequence = {path("a.obj")};
    pair.look = 3;
    const StrainSummary summary = evaluate_strain(pair);
    EXPECT_NEAR(summary.of("triangle/stretch_1").quantile(0.5), 1.2, 1e-9) << "files hold twelve decimals";
    EXPECT_NEAR(summary.of("vertex/surface_stretch_2").quantile(0.5), 0.9, 1e-9);
    ASSERT_EQ(summary.path.size(), 3u) << "one frame, one picture";
    const files::Hdf5File file = files::Hdf5File::open(path("out/strain.h5"));
    const std::vector<double> value = file.read<double>("/triangle/stretch", {1, mesh_.triangle_count(), 2}).value;
    for (size_t k = 0; k < value.size(); ++k) EXPECT_NEAR(value[k], k % 2 == 0 ? 1.2 : 0.9, 1e-9);
    // F in the stored frame takes the edges where they are.
    const std::vector<double> axis = file.read<double>("/mesh/triangle_axis").value;
    const std::vector<double> f = file.read<double>("/triangle/gradient").value;
    const Eigen::Vector3d edge =
        mesh_.rest_position.row(mesh_.triangle(5, 1)) - mesh_.rest_position.row(mesh_.triangle(5, 0));
    const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> axis_5(axis.data() + 30);
    const Eigen::Map<const Eigen::Matrix<double, 3, 2, Eigen::RowMajor>> f_5(f.data() + 30);
    EXPECT_NEAR((f_5 * (axis_5 * edge) - turn() * stretch * edge).norm(), 0, 1e-10);
    EXPECT_EQ(file.read_strings("/frames/name"), std::vector<std::string>{path("a.obj")});
    EXPECT_FALSE(file.has("/triangle/velocity_gradient"));
    const files::MetricFile metrics = files::read_metric_file(path("out/strain.json"), "strain");
    for (const files::Metric& metric : metrics.metric) {
        if (metric.name == "strain/triangle/stretch_1") {
            EXPECT_NEAR(metric.distribution->largest, 1.2, 1e-9);
        } else if (metric.name == "strain/triangle/compression") {
            EXPECT_NEAR(metric.value, 0.1, 1e-9);
        } else if (metric.unit == "count") {
            EXPECT_EQ(metric.value, 0) << metric.name;
        }
    }
}

TEST_F(Strain, MeasuresTheRatesOfASequence) {
    write_sequence(12, 0.01);
    StrainOptions sequence = options();
    sequence.sequence = {path("frames")};
    sequence.time_step = 0.01;
    const StrainSummary summary = evaluate_strain(sequence);
    EXPECT_NEAR(summary.of("triangle/rate_1").quantile(0.5), 0.5, 2e-4);
    EXPECT_NEAR(summary.of("triangle/spin").quantile(0.5), 2, 2e-3);
    EXPECT_NEAR(summary.of("vertex/spin").quantile(0.5), 2, 2e-3);
    EXPECT_GT(summary.of("triangle/rate_error").quantile(0.5), 1e-6);
    EXPECT_LT(summary.of("triangle/rate_error").tally.largest(), 2e-3);
    EXPECT_EQ(summary.triangle_rates_missing + summary.vertex_rates_missing, 0);
    const files::Hdf5File file = files::Hdf5File::open(path("out/strain.h5"));
    EXPECT_EQ(file.shape("/triangle/velocity_gradient"), (files::Shape{12, mesh_.triangle_count(), 3, 3}));
    for (const double rate : file.read<double>("/triangle/strain_rate").value)
        EXPECT_TRUE(std::abs(rate - 0.5) < 2e-3 || std::abs(rate) < 2e-3) << "no frame without its rates: " << rate;
    EXPECT_EQ(file.read_strings("/frames/name").at(10), path("frames/f10.ply")) << "numbers by their value";
    EXPECT_NEAR(summary.frame.at(11).triangle.largest_1, std::exp(0.5 * 0.11), 1e-9);
}

TEST_F(Strain, WritesTheSameBytesWithAnyNumberOfJobs) {
    write_sequence(6, 0.02);
    for (const int jobs : {1, 3}) {
        StrainOptions one = options("jobs" + std::to_string(jobs));
        one.sequence = {path("frames/*.ply")};
        one.time_step = 0.02;
        one.jobs = jobs;
        one.look = 2;
        evaluate_strain(one);
    }
    for (const char* name : {"strain.h5", "strain.json", "strain_0000.ply", "strain_0005.ply"})
        EXPECT_EQ(bytes(std::string("jobs1/") + name), bytes(std::string("jobs3/") + name)) << name;
}

TEST_F(Strain, RefusesInputAtFaultAndLeavesNothing) {
    write_sequence(3, 0.1);
    StrainOptions one = options();
    one.sequence = {path("frames")};
    files::write_mesh(path("frames/f3.ply"), sheet(5).triangle, sheet(5).rest_position);
    EXPECT_THAT(refusal(one), HasSubstr("f3.ply the mesh has 36 vertices, the rest state 49; this is frame 3"));
    Triangles other = mesh_.triangle;
    other.row(4).reverseInPlace();
    files::write_mesh(path("frames/f3.ply"), other, mesh_.rest_position);
    EXPECT_THAT(refusal(one), HasSubstr("f3.ply triangle 4 joins other vertices"));
    files::write_mesh(path("frames/f3.ply"), mesh_.triangle.topRows(9), mesh_.rest_position);
    EXPECT_THAT(refusal(one), HasSubstr("9 triangles"));
    std::ofstream(path("frames/f3.ply")) << "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n0 0";
    EXPECT_THAT(refusal(one), HasSubstr("f3.ply"));
    std::ofstream(path("frames/f3.ply")) << "";
    EXPECT_THAT(refusal(one), HasSubstr("f3.ply the file is empty"));
    fs::remove(path("frames/f3.ply"));
    std::ofstream(path("nan.obj")) << "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n";
    one.sequence = {path("nan.obj")};
    EXPECT_THAT(refusal(one), HasSubstr("nan.obj:3"));
    fs::create_directories(path("empty"));
    one.sequence = {path("empty")};
    EXPECT_THAT(refusal(one), HasSubstr("empty the folder has no .obj or .ply"));
    one.sequence = {path("none*.ply")};
    EXPECT_THAT(refusal(one), HasSubstr("no file matches"));
    one.sequence = {path("frames/f0.ply")};
    one.time_step = 0.1;
    EXPECT_THAT(refusal(one), HasSubstr("at least two frames"));
    one.time_step = NAN;
    EXPECT_THAT(refusal(one), HasSubstr("--time-step"));
    EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Strain, MeasuresADataSetFromItsPattern) {
    files::DatasetHeader header = test::header_of(false, false);
    {
        files::DatasetWriter writer(path("dataset.h5"), header, 4, 1);
        for (int slot = 0; slot < 4; ++slot) {
            files::SampleRecord sample = test::sample_of(header, slot);
            sample.cloth = header.mesh.rest_position * (1 + 0.25 * slot);
            writer.write(slot, sample);
        }
        writer.finish();
    }
    StrainOptions one = options();
    one.rest.clear();
    one.dataset = path("dataset.h5");
    const StrainSummary summary = evaluate_strain(one);  // slots 0 and 2 are accepted
    ASSERT_EQ(summary.frame.size(), 2u);
    EXPECT_EQ(summary.frame[1].name, "sample 102");
    EXPECT_NEAR(summary.frame[1].triangle.largest_1, 1.5, 1e-6);
    EXPECT_THAT(summary.note, ::testing::Contains(HasSubstr("no rates")));
    EXPECT_THAT(summary.note, ::testing::Contains(HasSubstr("2 samples that were not accepted")));
    // The same frames as meshes, with the data set's pattern for their rest state.
    StrainOptions meshes = options("meshes");
    meshes.rest = path("dataset.h5");
    files::write_mesh(path("large.ply"), header.mesh.triangle, header.mesh.rest_position * 1.5);
    meshes.sequence = {path("large.ply")};
    EXPECT_NEAR(evaluate_strain(meshes).of("triangle/stretch_2").quantile(0.5), 1.5, 1e-9);
    one.split = {"validation"};
    EXPECT_THAT(refusal(one), HasSubstr("no accepted sample"));
    one.split.clear();
    one.time_step = 0.1;
    EXPECT_THAT(refusal(one), HasSubstr("no time between them"));
}

TEST_F(Strain, CountsWhatIsDegenerate) {
    mesh_.rest_position.row(8) = mesh_.rest_position.row(0);
    files::write_mesh(path("rest.obj"), mesh_.triangle, mesh_.rest_position);
    StrainOptions one = options();
    one.sequence = {path("rest.obj")};
    const StrainSummary summary = evaluate_strain(one);
    EXPECT_EQ(summary.triangle_fault[static_cast<size_t>(StrainFault::degenerate_rest)], 2);
    EXPECT_THAT(strain_table(summary), HasSubstr("2 degenerate rest"));
    const std::optional<ReportSection> section = strain_section(path("out"));
    ASSERT_TRUE(section);
    const nlohmann::ordered_json page = as_json(*section);
    EXPECT_THAT(page.dump(), HasSubstr("degenerate rest"));
}

TEST_F(Strain, TellsTheReport) {
    EXPECT_FALSE(strain_section(path(".")));
    write_sequence(7, 0.01, ".obj");
    StrainOptions one = options();
    one.sequence = {path("frames")};
    one.time_step = 0.01;
    evaluate_strain(one);
    const std::optional<ReportSection> section = strain_section(path("out"));
    ASSERT_TRUE(section);
    const nlohmann::ordered_json page = as_json(*section);
    EXPECT_EQ(page.at("id"), "strain");
    std::vector<std::string> id;
    for (const auto& block : page.at("blocks")) id.push_back(block.at("id"));
    EXPECT_THAT(id, ::testing::ElementsAre("strain-triangle-stretch", "strain-vertex-stretch", "strain-rates",
                                           "strain-quantities", "strain-frames"));
    EXPECT_EQ(page.at("blocks").back().at("rows").size(), 7u);
    std::ofstream(path("out/strain.json")) << "{}";
    EXPECT_THROW(strain_section(path("out")), Error);
}

TEST_F(Strain, ColoursStretch) {
    EXPECT_EQ(stretch_colour(1), Eigen::RowVector3d(1, 1, 1));
    EXPECT_GT(stretch_colour(1.25)[0], stretch_colour(1.25)[2]);
    EXPECT_EQ(stretch_colour(1.25), stretch_colour(9));
    EXPECT_GT(stretch_colour(0.75)[2], stretch_colour(0.75)[0]);
    const StrainRest rest = strain_rest(mesh_, "");
    const Positions wide = mapped(mesh_.rest_position, Eigen::Vector3d(1.25, 0.9, 1).asDiagonal());
    for (const double shown : shown_stretch(rest, triangle_strain(rest, wide, 1))) EXPECT_NEAR(shown, 1.25, 1e-12);
    for (const char* name : {"a.ply", "a.glb"})
        write_coloured_mesh(path(name), rest, wide, triangle_strain(rest, wide, 1));
    EXPECT_THAT(bytes("a.ply"), HasSubstr("property uchar red"));
    EXPECT_THAT(bytes("a.glb"), HasSubstr("COLOR_0"));
    const files::MeshFrame back = files::read_mesh_frame(path("a.ply"));
    EXPECT_EQ(back.position, wide) << "colours shift nothing";
    EXPECT_EQ(files::read_mesh(path("a.glb")).position.rows(), wide.rows());
}

}  // namespace
}  // namespace toile::evaluate

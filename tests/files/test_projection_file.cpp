#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "cloth/error.h"
#include "files/projection_file.h"
#include "tests/support/file_size_limit.h"

namespace toile::files {
namespace {

using testing::HasSubstr;

/// One triangle, with one sample a call.
ProjectionHeader header_of(bool limits, bool gradient) {
    ProjectionHeader header;
    header.mesh.triangle = (Triangles(1, 3) << 0, 1, 2).finished();
    header.mesh.rest_position = Positions::Identity(3, 3);
    header.target_stiffness = Eigen::Vector3d(1, 2, 3);
    header.gradient = gradient;
    header.tolerance = 1e-6;
    header.config = "tolerance = 1e-06\n";
    header.config_hash = "0123456789abcdef0123456789abcdef";
    header.program_version = "0.1.0";
    const Edges edge = (Edges(3, 2) << 0, 1, 0, 2, 1, 2).finished();
    const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
    if (limits) {
        header.limits = LimitTables{edge, 1.5 * ones};
        return header;
    }
    SpringTables springs;
    springs.edge_spring = edge;
    springs.edge_stiffness = 5 * ones;
    springs.edge_rest_length = ones;
    springs.bending_spring = edge.topRows(1);
    springs.bending_stiffness = springs.bending_rest_length = Eigen::VectorXd::Constant(1, 0.5);
    springs.axial_spring.resize(1, 4);
    springs.axial_spring << 0, 1, 2, 0;
    springs.axial_weight.resize(1, 2);
    springs.axial_weight << 0.25, 0.75;
    springs.axial_stiffness = Eigen::VectorXd::Constant(1, 0.125);
    header.springs = springs;
    return header;
}

/// `count` samples whose numbers are all different.
struct Samples {
    std::vector<double> positions, edges, vertices;
    ProjectionRows rows;

    Samples(const ProjectionHeader& header, int first, int count) {
        auto fill = [&](std::vector<double>& value, int width) {
            for (int i = 0; i < count * width; ++i) value.push_back(first * width + i + 0.5);
        };
        fill(positions, 9);
        fill(edges, 3);
        fill(vertices, 3);
        rows.predicted = rows.projected = positions;
        rows.status.assign(static_cast<size_t>(count), static_cast<int8_t>(first % 3));
        rows.iterations.assign(static_cast<size_t>(count), 10 + first);
        rows.seconds = rows.residual = std::vector<double>(static_cast<size_t>(count), 0.125 * first);
        if (header.limits) rows.multiplier = edges;
        if (!header.gradient) return;
        rows.loss = rows.gradient_seconds = rows.gradient_residual = rows.seconds;
        rows.gradient = positions;
        if (header.limits) {
            rows.weakly_active = rows.iterations;
            rows.active_set_distance = rows.seconds;
        } else {
            rows.gradient_mu = rows.seconds;
            rows.gradient_mu_vertex = vertices;
        }
    }
};

class ProjectionFileTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("toile_projection_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        path_ = (folder_ / "p.h5").string();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    bool left_nothing() const { return std::filesystem::is_empty(folder_); }

    void write(const ProjectionHeader& header, int samples, int at_once) const {
        ProjectionWriter writer(path_, header, samples);
        for (int first = 0; first < samples; first += at_once)
            writer.write(Samples(header, first, std::min(at_once, samples - first)).rows);
        writer.finish();
    }

    std::filesystem::path folder_;
    std::string path_;
};

TEST_F(ProjectionFileTest, holds_what_the_contract_says) {
    for (const bool limits : {true, false}) {
        write(header_of(limits, true), 5, 2);
        const Hdf5File file = Hdf5File::open(path_);
        EXPECT_EQ(file.string_attribute("/", "format"), "toile");
        EXPECT_EQ(file.integer_attribute("/", "version"), projection_version);
        EXPECT_EQ(file.string_attribute("/", "config"), "tolerance = 1e-06\n");
        EXPECT_EQ(file.type_name("/samples/status"), "int8");
        EXPECT_EQ(file.shape("/samples/projected"), (Shape{5, 3, 3}));
        EXPECT_EQ(file.shape("/samples/gradient"), (Shape{5, 3, 3}));
        for (const char* name : {"iterations", "seconds", "residual", "loss", "gradient_seconds"})
            EXPECT_EQ(file.shape(std::string("/samples/") + name), (Shape{5})) << name;
        EXPECT_EQ(file.read<double>("/model/target_stiffness").value, (std::vector<double>{1, 2, 3}));
        if (limits) {
            EXPECT_EQ(file.type_name("/model/edge"), "int32");
            EXPECT_EQ(file.read<double>("/model/edge_max_length").value, std::vector<double>(3, 1.5));
            EXPECT_EQ(file.shape("/samples/multiplier"), (Shape{5, 3}));
            EXPECT_EQ(file.shape("/samples/weakly_active"), (Shape{5}));
        } else {
            EXPECT_EQ(file.shape("/model/bending_spring"), (Shape{1, 2}));
            EXPECT_EQ(file.read<int>("/model/axial_spring").value, (std::vector<int>{0, 1, 2, 0}));
            EXPECT_EQ(file.read<double>("/model/axial_weight").value, (std::vector<double>{0.25, 0.75}));
            EXPECT_EQ(file.shape("/samples/gradient_mu"), (Shape{5}));
            EXPECT_EQ(file.shape("/samples/gradient_mu_vertex"), (Shape{5, 3}));
        }
    }
}

TEST_F(ProjectionFileTest, gives_back_what_was_written) {
    const ProjectionHeader header = header_of(true, true);
    write(header, 7, 3);
    const ProjectionReader reader(path_);
    EXPECT_EQ(reader.sample_count(), 7);
    EXPECT_EQ(reader.header().prior(), std::string("inextensibility"));
    EXPECT_EQ(reader.header().tolerance, 1e-6);
    EXPECT_EQ(reader.header().mesh.triangle, header.mesh.triangle);
    EXPECT_EQ(reader.header().mesh.pattern_position.rows(), 0);
    EXPECT_EQ(reader.header().limits->edge, header.limits->edge);
    const StoredProjection all = reader.read(0, 7);
    const Samples expected(header, 0, 7);
    EXPECT_EQ(all.projected, expected.positions);
    EXPECT_EQ(all.multiplier, expected.edges);
    const StoredProjection last = reader.read(6, 1);
    EXPECT_EQ(last.status[0], 0);
    EXPECT_EQ(last.residual[0], 0.75);
    EXPECT_EQ(last.gradient, Samples(header, 6, 1).positions);
}

TEST_F(ProjectionFileTest, springs_come_back_too) {
    const ProjectionHeader header = header_of(false, false);
    write(header, 2, 2);
    const ProjectionReader reader(path_);
    ASSERT_TRUE(reader.header().springs);
    EXPECT_EQ(reader.header().springs->axial_weight, header.springs->axial_weight);
    EXPECT_EQ(reader.header().springs->bending_stiffness, header.springs->bending_stiffness);
    EXPECT_FALSE(reader.header().gradient);
    EXPECT_TRUE(reader.read(0, 2).multiplier.empty());
}

TEST_F(ProjectionFileTest, the_mesh_keeps_its_pattern_and_mass) {
    ProjectionHeader header = header_of(true, false);
    header.mesh.pattern_position = PlanePositions::Random(4, 2);
    header.mesh.pattern_triangle = header.mesh.triangle;
    header.mesh.mass = Eigen::Vector3d(1, 2, 3);
    write(header, 1, 1);
    const ProjectionReader reader(path_);
    EXPECT_EQ(reader.header().mesh.pattern_position, header.mesh.pattern_position);
    EXPECT_EQ(reader.header().mesh.mass, header.mesh.mass);
}

TEST_F(ProjectionFileTest, no_samples_and_no_edges_are_numbers_like_others) {
    ProjectionHeader header = header_of(true, true);
    write(header, 0, 1);
    EXPECT_EQ(ProjectionReader(path_).sample_count(), 0);
    header.limits = LimitTables{Edges(0, 2), Eigen::VectorXd()};
    ProjectionWriter writer(path_, header, 1);
    Samples one(header, 0, 1);
    one.rows.multiplier = {};
    writer.write(one.rows);
    writer.finish();
    EXPECT_EQ(Hdf5File::open(path_).shape("/samples/multiplier"), (Shape{1, 0}));
}

TEST_F(ProjectionFileTest, an_unfinished_file_leaves_nothing) {
    const ProjectionHeader header = header_of(true, false);
    {
        ProjectionWriter writer(path_, header, 2);
        writer.write(Samples(header, 0, 1).rows);
        EXPECT_THROW(writer.finish(), Error);
    }
    EXPECT_TRUE(left_nothing());
}

TEST_F(ProjectionFileTest, refuses_samples_that_do_not_fit) {
    const ProjectionHeader header = header_of(true, true);
    ProjectionWriter writer(path_, header, 1);
    Samples one(header, 0, 1);
    one.rows.multiplier = one.rows.multiplier.first(2);
    EXPECT_THROW(writer.write(one.rows), Error);
    EXPECT_THROW(writer.write(Samples(header, 0, 2).rows), Error);
    EXPECT_THROW(ProjectionWriter(path_, ProjectionHeader{}, 1), Error);
}

TEST_F(ProjectionFileTest, refuses_places_it_cannot_write_to) {
    EXPECT_THROW(ProjectionWriter((folder_ / "no" / "p.h5").string(), header_of(true, false), 1), Error);
    EXPECT_THROW(ProjectionWriter(folder_.string(), header_of(true, false), 1), Error);
}

TEST_F(ProjectionFileTest, a_full_disk_leaves_nothing) {
    const test::FileSizeLimit limit(20000);
    EXPECT_THROW(write(header_of(true, true), 500, 10), Error);
    EXPECT_TRUE(left_nothing());
}

TEST_F(ProjectionFileTest, refuses_files_of_others) {
    Hdf5File::create(path_).close();
    EXPECT_THROW(ProjectionReader{path_}, Error);
    write(header_of(true, false), 1, 1);
    Hdf5File file = Hdf5File::edit(path_);
    file.set_attribute("/", "version", projection_version + 1);
    file.close();
    try {
        ProjectionReader reader(path_);
        ADD_FAILURE() << "a later version was read";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("version"));
    }
}

}  // namespace
}  // namespace toile::files

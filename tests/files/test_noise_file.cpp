#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "cloth/error.h"
#include "files/noise_file.h"

namespace toile::files {
namespace {

class NoiseFile : public testing::Test {
  protected:
    void SetUp() override {
        path_ = (std::filesystem::temp_directory_path() / ("toile_noise_" + std::to_string(getpid()) + ".h5")).string();
        header_.mesh.triangle = (Triangles(1, 3) << 0, 1, 2).finished();
        header_.mesh.rest_position = (Positions(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished();
        header_.variant = {{"half_step", "half the step"}, {"second_solver", "another solver"}};
        header_.missing = {"third: not there"};
        header_.reasons = {"accepted", "not_at_rest"};
        header_.config = "[scene]\n";
        header_.config_hash = "12ab";
        header_.program_version = "0.1.0";
        header_.seed = 5;
        header_.share = 0.25;
    }
    void TearDown() override { std::filesystem::remove(path_); }

    static NoiseRecord record(int64_t id) {
        NoiseRecord record;
        record.id = id;
        record.status = 1;
        record.cloth = Positions::Constant(3, 3, 0.5 * static_cast<double>(id));
        const Positions cloth = Positions::Constant(3, 3, 0.25);
        record.variant = {{0, cloth, Eigen::Vector3d(1, 2, 3)}, {1, 2.0 * cloth, Eigen::Vector3d(4, 5, 6)}};
        record.spread = Eigen::Vector3d(7, 8, 9);
        record.spread_rms = 8.04;
        record.spread_max = 9;
        return record;
    }

    std::string path_;
    NoiseHeader header_;
};

TEST_F(NoiseFile, reads_what_it_wrote) {
    {
        NoiseWriter writer(path_, header_, 2);
        writer.write(record(3));
        writer.write(record(8));
        writer.finish();
    }
    const NoiseReader file(path_);
    EXPECT_EQ(file.sample_count(), 2);
    EXPECT_EQ(file.header().variant.at(1).name, "second_solver");
    EXPECT_EQ(file.header().variant.at(1).what, "another solver");
    EXPECT_EQ(file.header().missing, header_.missing);
    EXPECT_EQ(file.header().reasons, header_.reasons);
    EXPECT_EQ(file.header().config_hash, "12ab");
    EXPECT_EQ(file.header().seed, 5);
    EXPECT_EQ(file.header().share, 0.25);
    EXPECT_EQ(file.header().mesh.triangle, header_.mesh.triangle);
    const NoiseRecord second = file.read(1), expected = record(8);
    EXPECT_EQ(second.id, 8);
    EXPECT_EQ(second.status, 1);
    EXPECT_EQ(second.cloth, expected.cloth);
    ASSERT_EQ(second.variant.size(), 2u);
    EXPECT_EQ(second.variant[1].status, 1);
    EXPECT_EQ(second.variant[1].cloth, expected.variant[1].cloth);
    EXPECT_EQ(second.variant[1].distance, expected.variant[1].distance);
    EXPECT_EQ(second.spread, expected.spread);
    EXPECT_EQ(second.spread_rms, 8.04);
    EXPECT_EQ(second.spread_max, 9);
}

TEST_F(NoiseFile, refuses_what_does_not_fit) {
    NoiseWriter writer(path_, header_, 1);
    NoiseRecord wrong = record(0);
    wrong.cloth.resize(2, 3);
    EXPECT_THROW(writer.write(wrong), Error) << "cloth";
    wrong = record(0);
    wrong.spread.resize(4);
    EXPECT_THROW(writer.write(wrong), Error) << "spread";
    wrong = record(0);
    wrong.variant.pop_back();
    EXPECT_THROW(writer.write(wrong), Error) << "variants";
    wrong = record(0);
    wrong.variant[1].distance.resize(1);
    EXPECT_THROW(writer.write(wrong), Error) << "a variant's distances";
    wrong = record(0);
    wrong.variant[1].cloth.resize(2, 3);
    EXPECT_THROW(writer.write(wrong), Error) << "a variant's cloth";
    writer.write(record(0));
    EXPECT_THROW(writer.write(record(1)), Error) << "one sample too many";
}

TEST_F(NoiseFile, appears_whole_or_not_at_all) {
    {
        NoiseWriter writer(path_, header_, 2);
        writer.write(record(0));
        EXPECT_THROW(writer.finish(), Error);
    }
    EXPECT_FALSE(std::filesystem::exists(path_));
    EXPECT_FALSE(std::filesystem::exists(path_ + ".partial"));
    EXPECT_THROW(NoiseReader{path_}, Error);
}

TEST_F(NoiseFile, refuses_another_mesh) {
    {
        NoiseWriter writer(path_, header_, 1);
        writer.write(record(0));
        writer.finish();
    }
    {
        Hdf5File file = Hdf5File::edit(path_);
        file.remove("/samples/spread");
        file.write("/samples/spread", std::vector<double>(4), {1, 4});
        file.close();
    }
    EXPECT_THROW(NoiseReader{path_}, Error);
}

TEST_F(NoiseFile, refuses_another_version_or_kind) {
    {
        NoiseWriter writer(path_, header_, 1);
        writer.write(record(0));
        writer.finish();
    }
    EXPECT_NO_THROW(NoiseReader{path_});
    const auto set = [&](const char* kind, int64_t version) {
        Hdf5File file = Hdf5File::edit(path_);
        file.set_attribute("/", "kind", kind);
        file.set_attribute("/", "version", version);
        file.close();
    };
    set("noise", 1);  // without the variants' cloth
    try {
        const NoiseReader file(path_);
        FAIL() << "an older version";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the noise file has version 1, not 2");
        EXPECT_FALSE(error.mend().empty());
    }
    set("projection", 2);
    EXPECT_THROW(NoiseReader{path_}, Error);
}

}  // namespace
}  // namespace toile::files

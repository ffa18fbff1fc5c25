#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "cloth/error.h"
#include "files/replay_file.h"

namespace toile::files {
namespace {

using testing::HasSubstr;

CertificateRecord certificate(double residual, int tries) {
    CertificateRecord record{residual, 0.25, 1.5, 0.75, 0.125, 2.0, 7};
    record.detail = {0.5, 3, 40, 20, tries, tries - 1};
    return record;
}

ReplayRecord replay() {
    ReplayRecord record;
    record.config = "[scene]\nname = \"tiny\"\n";
    record.config_hash = "0123456789abcdef0123456789abcdef";
    record.program_version = "0.1.0";
    record.id = 123;
    record.reason = "not_at_rest";
    record.mesh.triangle.resize(2, 3);
    record.mesh.triangle << 0, 1, 2, 2, 1, 3;
    record.mesh.pattern_triangle = record.mesh.triangle;
    record.mesh.rest_position = Positions::Constant(4, 3, 0.5);
    record.mesh.pattern_position = record.mesh.rest_position.leftCols<2>();
    record.mesh.mass = Eigen::Vector4d::Constant(1.0 / 7.0);
    record.pose = Positions::Constant(2, 3, 0.1);
    record.start = Positions::Constant(4, 3, 1.0 / 3.0);
    record.cloth = Positions::Constant(4, 3, std::sqrt(2.0));
    record.certificate = certificate(0.1, 2);
    record.tries = {{"as configured", "not_at_rest", certificate(0.2, 1)},
                    {"smaller steps", "not_at_rest", certificate(0.1, 1)}};
    return record;
}

class ReplayFile : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("toile_replay_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name = "pose_000123.h5") const { return (folder_ / name).string(); }
    std::string bytes(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    /// What is said of a replay that was changed after it was written.
    std::string refusal(const std::function<void(Hdf5File&)>& change) const {
        write_replay(path(), replay());
        Hdf5File file = Hdf5File::edit(path());
        change(file);
        file.close();
        try {
            read_replay(path());
        } catch (const Error& error) {
            return error.what() + (" (" + error.where() + ")");
        }
        return "accepted";
    }
    std::filesystem::path folder_;
};

TEST_F(ReplayFile, ReadsBackToTheLastBit) {
    const ReplayRecord written = replay();
    write_replay(path(), written);
    const ReplayRecord read = read_replay(path());
    EXPECT_EQ(read.config, written.config);
    EXPECT_EQ(read.config_hash, written.config_hash);
    EXPECT_EQ(read.program_version, written.program_version);
    EXPECT_EQ(read.id, 123);
    EXPECT_EQ(read.reason, "not_at_rest");
    EXPECT_EQ(read.mesh.triangle, written.mesh.triangle);
    EXPECT_EQ(read.mesh.pattern_position, written.mesh.pattern_position);
    EXPECT_EQ(read.mesh.mass, written.mesh.mass);
    EXPECT_EQ(read.pose, written.pose);
    EXPECT_EQ(read.start, written.start);
    EXPECT_EQ(read.cloth, written.cloth);
    EXPECT_EQ(certificate_bytes(read.certificate), certificate_bytes(written.certificate));
    ASSERT_EQ(read.tries.size(), 2u);
    EXPECT_EQ(read.tries[1].rung, "smaller steps");
    EXPECT_EQ(read.tries[0].reason, "not_at_rest");
    EXPECT_EQ(read.tries[0].certificate.residual_force, 0.2);
    EXPECT_EQ(read.tries[0].certificate.detail->iterations, 40);
}

TEST_F(ReplayFile, KeepsAClothThatIsNotFinite) {
    ReplayRecord written = replay();
    written.cloth(2, 1) = std::numeric_limits<double>::quiet_NaN();
    write_replay(path(), written);
    EXPECT_TRUE(std::isnan(read_replay(path()).cloth(2, 1)));
}

TEST_F(ReplayFile, TheBytesDependOnTheRecordButNotOnItsTimes) {
    ReplayRecord slow = replay();
    slow.certificate.seconds = 100;
    slow.tries[0].certificate.seconds = 50;
    write_replay(path("one.h5"), replay());
    write_replay(path("two.h5"), slow);
    EXPECT_TRUE(bytes("one.h5") == bytes("two.h5"));
}

TEST_F(ReplayFile, RefusesDefectsOneByOne) {
    EXPECT_EQ(refusal([](Hdf5File&) {}), "accepted");
    EXPECT_THAT(refusal([](Hdf5File& f) { f.set_attribute("/", "kind", "dataset"); }), HasSubstr("not a replay"));
    EXPECT_THAT(refusal([](Hdf5File& f) { f.set_attribute("/", "format", "other"); }), HasSubstr("not a replay"));
    EXPECT_THAT(refusal([](Hdf5File& f) { f.set_attribute("/", "version", 99); }), HasSubstr("version 99"));
    for (const char* name : {"/mesh/triangle", "/replay/pose", "/replay/start", "/replay/cloth", "/replay/rung",
                             "/replay/rung_reason", "/certificate/max_speed"})
        EXPECT_THAT(refusal([&](Hdf5File& f) { f.remove(name); }), HasSubstr(name));
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/replay/cloth");
                    f.write("/replay/cloth", std::vector<double>(9, 0.0), {3, 3});
                }),
                HasSubstr("/replay/cloth"));
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/replay/start");
                    f.write("/replay/start", std::vector<double>(12, std::nan("")), {4, 3});
                }),
                HasSubstr("not finite"));
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/replay/rung_reason");
                    f.write_strings("/replay/rung_reason", {"not_at_rest"});
                }),
                HasSubstr("1 reasons for 2 rungs"));
}

TEST_F(ReplayFile, RefusesFilesThatAreNone) {
    EXPECT_THROW(read_replay(path("absent.h5")), Error);
    std::ofstream(path("text.h5")) << "not HDF5";
    EXPECT_THROW(read_replay(path("text.h5")), Error);
    EXPECT_THROW(write_replay(path("absent/pose.h5"), replay()), Error);
}

}  // namespace
}  // namespace toile::files

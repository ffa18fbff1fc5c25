#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numeric>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::files {
namespace {

using testing::HasSubstr;

using test::expect_same;
using test::header_of;
using test::sample_of;

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

class DatasetFileTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_dataset_" + std::string(info->name()) + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name = "dataset.h5") const { return (folder_ / name).string(); }
    void write(const std::string& name, const DatasetHeader& header, const std::vector<int>& order) const {
        DatasetWriter writer(path(name), header, static_cast<int>(order.size()), 4);
        for (const int slot : order) writer.write(slot, sample_of(header, slot));
        writer.finish();
    }
    std::filesystem::path folder_;
};

TEST_F(DatasetFileTest, ReadsBackWhatItWrote) {
    const DatasetHeader header = header_of(true, true);
    write("dataset.h5", header, {0, 1, 2, 3});
    const DatasetReader reader(path());
    EXPECT_EQ(reader.sample_count(), 4);
    EXPECT_EQ(reader.header().mesh.triangle, header.mesh.triangle);
    EXPECT_EQ(reader.header().mesh.mass, header.mesh.mass);
    EXPECT_EQ(reader.header().body->joint_name, header.body->joint_name);
    EXPECT_EQ(reader.header().body->joint_bind[1], header.body->joint_bind[1]);
    EXPECT_EQ(reader.header().embedding->barycentric, header.embedding->barycentric);
    EXPECT_EQ(reader.header().image->mask, header.image->mask);
    EXPECT_EQ(reader.header().config, header.config);
    EXPECT_EQ(reader.header().reasons, header.reasons);
    EXPECT_EQ(reader.header().gate, header.gate);
    EXPECT_EQ(reader.header().seed, 42);
    EXPECT_FALSE(reader.part());
    for (int slot = 0; slot < 4; ++slot) {
        expect_same(reader.read(slot), sample_of(header, slot));
        EXPECT_EQ(reader.stored_digest(slot), sample_digest(sample_of(header, slot)));
    }
}

TEST_F(DatasetFileTest, HoldsTheContractsNamesAndTypes) {
    write("dataset.h5", header_of(true, true), {0, 1});
    const Hdf5File file = Hdf5File::open(path());
    const std::vector<std::tuple<std::string, std::string, Shape>> expected{
        {"/mesh/triangle", "int32", {1, 3}},
        {"/mesh/rest_position", "float64", {3, 3}},
        {"/mesh/pattern_position", "float64", {3, 2}},
        {"/mesh/pattern_triangle", "int32", {1, 3}},
        {"/mesh/mass", "float64", {3}},
        {"/body/triangle", "int32", {1, 3}},
        {"/body/rest_position", "float64", {3, 3}},
        {"/body/joint_name", "string", {2}},
        {"/body/joint_parent", "int32", {2}},
        {"/body/joint_bind", "float64", {2, 4, 4}},
        {"/body/weight_vertex", "int32", {3}},
        {"/body/weight_joint", "int32", {3}},
        {"/body/weight_value", "float64", {3}},
        {"/embedding/triangle", "int32", {3}},
        {"/embedding/barycentric", "float64", {3, 3}},
        {"/samples/id", "int64", {2}},
        {"/samples/pose", "float64", {2, 2, 3}},
        {"/samples/split", "int8", {2}},
        {"/samples/cloth", "float32", {2, 3, 3}},
        {"/samples/embedded", "float32", {2, 3, 3}},
        {"/samples/displacement", "float32", {2, 3, 3}},
        {"/samples/frame", "float32", {2, 3, 4}},
        {"/samples/image", "float32", {2, 3, 2, 2}},
        {"/image/pattern_pixel", "float64", {3, 3}},
        {"/image/mask", "uint8", {1, 2, 2}},
        {"/samples/status", "int8", {2}},
        {"/certificate/residual_force", "float64", {2}},
        {"/certificate/body_penetration", "float64", {2}},
        {"/certificate/self_intersections", "int32", {2}},
        {"/certificate/max_stretch", "float64", {2}},
        {"/certificate/min_stretch", "float64", {2}},
        {"/certificate/max_speed", "float64", {2}},
        {"/certificate/seconds", "float64", {2}},
        {"/samples/digest", "uint8", {2, 16}},
        {"/samples/resampling_error", "float64", {2, 2}}};
    for (const auto& [name, type, shape] : expected) {
        ASSERT_TRUE(file.has(name)) << name;
        EXPECT_EQ(file.type_name(name), type) << name;
        EXPECT_EQ(file.shape(name), shape) << name;
    }
    EXPECT_EQ(file.string_attribute("/", "format"), "toile");
    EXPECT_EQ(file.integer_attribute("/", "version"), dataset_version);
    EXPECT_EQ(file.read<float>("/samples/frame").value[1], -0.5f);  // (w, x, y, z)
}

TEST_F(DatasetFileTest, WhatTheSceneLacksIsAbsent) {
    write("dataset.h5", header_of(false, false), {0});
    const Hdf5File file = Hdf5File::open(path());
    EXPECT_EQ(file.members("/"), (std::vector<std::string>{"certificate", "mesh", "samples"}));
    EXPECT_EQ(file.members("/samples"), (std::vector<std::string>{"cloth", "digest", "id", "split", "status"}));
    expect_same(DatasetReader(path()).read(0), sample_of(header_of(false, false), 0));
    write("no_image.h5", header_of(true, false), {0});
    EXPECT_FALSE(Hdf5File::open(path("no_image.h5")).has("/image"));
    EXPECT_FALSE(Hdf5File::open(path("no_image.h5")).has("/samples/image"));
}

TEST_F(DatasetFileTest, TheOrderOfWritingDoesNotChangeTheBytes) {
    const DatasetHeader header = header_of(true, true);
    for (const char* folder : {"forward", "shuffled"}) std::filesystem::create_directory(folder_ / folder);
    write("forward/dataset.h5", header, {0, 1, 2, 3, 4});
    write("shuffled/dataset.h5", header, {3, 0, 4, 2, 1});
    EXPECT_TRUE(bytes_of(path("forward/dataset.h5")) == bytes_of(path("shuffled/dataset.h5")));
}

TEST_F(DatasetFileTest, WallTimeIsReadThroughALinkAndChangesNoByteOfTheDataset) {
    const DatasetHeader header = header_of(true, true);
    for (const char* folder : {"a", "b"}) std::filesystem::create_directory(folder_ / folder);
    write("a/dataset.h5", header, {0, 1});
    DatasetWriter writer(path("b/dataset.h5"), header, 2, 4);
    for (int slot = 0; slot < 2; ++slot) {
        SampleRecord sample = sample_of(header, slot);
        sample.certificate.seconds *= 2;
        EXPECT_EQ(sample_digest(sample), sample_digest(sample_of(header, slot)));
        writer.write(slot, sample);
    }
    writer.finish();
    EXPECT_TRUE(bytes_of(path("a/dataset.h5")) == bytes_of(path("b/dataset.h5")));
    EXPECT_EQ(DatasetReader(path("a/dataset.h5")).read(1).certificate.seconds, 1.5);
    EXPECT_EQ(DatasetReader(path("b/dataset.h5")).read(1).certificate.seconds, 3.0);
    EXPECT_EQ(Hdf5File::open(path("b/dataset.h5")).read<double>("/certificate/seconds").value,
              (std::vector<double>{1.0, 3.0}));

    std::filesystem::remove(timing_path(path("b/dataset.h5")));
    EXPECT_TRUE(std::isnan(DatasetReader(path("b/dataset.h5")).read(1).certificate.seconds));
}

TEST_F(DatasetFileTest, TheResamplingErrorIsGatheredFromTheAcceptedSamples) {
    write("dataset.h5", header_of(true, true), {0, 1, 2, 3});  // 1 and 3 failed
    const std::array<double, 2> error = *DatasetReader(path()).header().resampling_error;
    EXPECT_DOUBLE_EQ(error[0], 3e-4);
    EXPECT_DOUBLE_EQ(error[1], 1e-5 * std::sqrt((1.0 + 9.0) / 2));
    EXPECT_EQ(Hdf5File::open(path()).numbers_attribute("/", "resampling_error"),
              (std::vector<double>{error[0], error[1]}));

    Hdf5File before = Hdf5File::edit(path());  // data sets made before it was kept for each sample
    before.remove("/samples/resampling_error");
    before.close();
    EXPECT_EQ(DatasetReader(path()).read(2).resampling_error, (std::array<double, 2>{0, 0}));
    EXPECT_EQ(*DatasetReader(path()).header().resampling_error, error);
}

TEST_F(DatasetFileTest, APartHoldsItsSecondsAndItsPlace) {
    const DatasetHeader header = header_of(true, true);
    const auto write_part = [&](double seconds) {
        DatasetWriter writer(path(), header, 2, 4, CorpusPart{3, 16, 512, 4096});
        for (int slot = 0; slot < 2; ++slot) {
            SampleRecord sample = sample_of(header, slot);
            sample.certificate.seconds = seconds + slot;
            writer.write(slot, sample);
        }
        writer.finish();
    };
    write_part(7.0);
    EXPECT_FALSE(std::filesystem::exists(timing_path(path())));
    const DatasetReader reader(path());
    EXPECT_EQ(reader.read(1).certificate.seconds, 8.0);
    ASSERT_TRUE(reader.part());
    EXPECT_EQ(reader.part()->shard, 3);
    EXPECT_EQ(reader.part()->shards, 16);
    EXPECT_EQ(reader.part()->first_slot, 512);
    EXPECT_EQ(reader.part()->corpus_samples, 4096);
}

TEST_F(DatasetFileTest, ManySamplesAndNone) {
    const DatasetHeader header = header_of(false, false);
    std::vector<int> order(9000);
    std::iota(order.begin(), order.end(), 0);
    write("many.h5", header, order);
    const DatasetReader many(path("many.h5"));
    ASSERT_EQ(many.sample_count(), 9000);
    for (const int slot : {0, 4095, 4096, 8191, 8192, 8999}) {
        expect_same(many.read(slot), sample_of(header, slot));
        EXPECT_EQ(many.stored_digest(slot), sample_digest(sample_of(header, slot)));
    }
    write("none.h5", header, {});
    EXPECT_EQ(DatasetReader(path("none.h5")).sample_count(), 0);
    EXPECT_EQ(DatasetReader(path("none.h5")).header().gate, header.gate);
}

TEST_F(DatasetFileTest, RefusesCertificatesOfTwoKinds) {
    const DatasetHeader header = header_of(false, false);
    DatasetWriter writer(path(), header, 2, 4);
    SampleRecord detailed = sample_of(header, 0);
    detailed.certificate.detail.emplace();
    writer.write(0, detailed);
    writer.write(1, sample_of(header, 1));
    EXPECT_THAT(message_of([&] { writer.finish(); }), HasSubstr("detailed certificate"));
}

TEST_F(DatasetFileTest, DigestSeesEveryArray) {
    const DatasetHeader header = header_of(true, true);
    const SampleRecord sample = sample_of(header, 1);
    const std::vector<std::function<void(SampleRecord&)>> change{
        [](SampleRecord& s) { s.id = 5; },
        [](SampleRecord& s) { s.split = 2; },
        [](SampleRecord& s) { s.status = 0; },
        [](SampleRecord& s) { s.pose(1, 2) += 1e-12; },
        [](SampleRecord& s) { s.cloth(2, 2) += 1e-6; },
        [](SampleRecord& s) { s.embedded(2, 2) += 1e-6; },
        [](SampleRecord& s) { s.displacement(0, 0) += 1e-6; },
        [](SampleRecord& s) { s.frame[2].w() += 1e-6; },
        [](SampleRecord& s) { s.image[11] += 1e-6f; },
        [](SampleRecord& s) { s.certificate.self_intersections += 1; },
        [](SampleRecord& s) { s.certificate.max_speed += 1e-12; }};
    for (size_t i = 0; i < change.size(); ++i) {
        SampleRecord changed = sample;
        change[i](changed);
        EXPECT_NE(sample_digest(changed), sample_digest(sample)) << i;
    }
}

TEST_F(DatasetFileTest, FailedSamplesAreKeptAsTheyEnded) {
    const DatasetHeader header = header_of(true, true);
    SampleRecord sample = sample_of(header, 1);
    sample.cloth(1, 1) = std::numeric_limits<double>::quiet_NaN();
    sample.image[3] = std::numeric_limits<float>::quiet_NaN();
    DatasetWriter writer(path(), header, 1, 4);
    writer.write(0, sample);
    writer.finish();
    const DatasetReader reader(path());
    EXPECT_TRUE(std::isnan(reader.read(0).cloth(1, 1)));
    EXPECT_EQ(reader.read(0).status, 1);
    EXPECT_EQ(reader.stored_digest(0), sample_digest(reader.read(0)));
}

TEST_F(DatasetFileTest, NothingIsLeftWithoutFinish) {
    const DatasetHeader header = header_of(true, true);
    {
        DatasetWriter writer(path(), header, 2, 4);
        writer.write(0, sample_of(header, 0));
        EXPECT_FALSE(std::filesystem::exists(path()));
        EXPECT_THAT(message_of([&] { writer.finish(); }), HasSubstr("slot 1 of 2"));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(DatasetFileTest, AFullDiskLeavesNothingBehind) {
    const DatasetHeader header = header_of(true, true);
    write("dataset.h5", header, {0, 1, 2});
    const auto size = static_cast<rlim_t>(std::filesystem::file_size(path()));
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) std::filesystem::remove(entry);
    for (rlim_t bytes = 0; bytes < size; bytes += size / 17 + 1) {
        const test::FileSizeLimit limit(bytes);
        EXPECT_THROW(write("dataset.h5", header, {0, 1, 2}), Error) << bytes;
        EXPECT_TRUE(std::filesystem::is_empty(folder_)) << bytes;
    }
    write("dataset.h5", header, {0, 1, 2});
    EXPECT_EQ(DatasetReader(path()).sample_count(), 3);
}

TEST_F(DatasetFileTest, RefusesSamplesThatDoNotFit) {
    const DatasetHeader header = header_of(true, true);
    DatasetWriter writer(path(), header, 2, 4);
    writer.write(0, sample_of(header, 0));
    EXPECT_THAT(message_of([&] { writer.write(0, sample_of(header, 0)); }), HasSubstr("written before"));
    EXPECT_THAT(message_of([&] { writer.write(2, sample_of(header, 2)); }), HasSubstr("no slot 2"));
    const std::vector<std::pair<std::string, std::function<void(SampleRecord&)>>> defect{
        {"cloth", [](SampleRecord& s) { s.cloth.resize(2, 3); }},
        {"pose", [](SampleRecord& s) { s.pose.resize(3, 3); }},
        {"embedded", [](SampleRecord& s) { s.embedded.resize(0, 3); }},
        {"displacement", [](SampleRecord& s) { s.displacement.resize(4, 3); }},
        {"frame", [](SampleRecord& s) { s.frame.pop_back(); }},
        {"image", [](SampleRecord& s) { s.image.pop_back(); }},
        {"status 2", [](SampleRecord& s) { s.status = 2; }},
        {"split 3", [](SampleRecord& s) { s.split = 3; }}};
    for (const auto& [word, damage] : defect) {
        SampleRecord sample = sample_of(header, 1);
        damage(sample);
        EXPECT_THAT(message_of([&] { writer.write(1, sample); }), HasSubstr(word));
    }
}

TEST_F(DatasetFileTest, ReaderRefusesWhatIsNotADataset) {
    Hdf5File other = Hdf5File::create(path("other.h5"));
    other.write("/samples/id", std::vector<int64_t>{1}, {1});
    other.close();
    EXPECT_THAT(message_of([&] { DatasetReader reader(path("other.h5")); }), HasSubstr("not one of toile's"));
    write("dataset.h5", header_of(true, true), {0});
    Hdf5File newer = Hdf5File::edit(path());
    newer.set_attribute("/", "version", 99);
    newer.close();
    EXPECT_THAT(message_of([&] { DatasetReader reader(path()); }), HasSubstr("version 99"));
}

}  // namespace
}  // namespace toile::files

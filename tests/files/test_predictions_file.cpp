#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cloth/error.h"
#include "files/predictions_file.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::files {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Samples 100 to 105 of three vertices, in splits 0 1 2 0 1 2, of which 104 is not accepted.
class PredictionsFile : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "toile_predictions_file_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
        path = (folder / "mine.h5").string();
        dataset = (folder / "dataset.h5").string();
        write_dataset([](SampleRecord&) {});
    }
    void TearDown() override { fs::remove_all(folder); }

    void write_dataset(const std::function<void(SampleRecord&)>& change) const {
        const DatasetHeader header = test::header_of(true, false);
        DatasetWriter writer(dataset, header, 6, 1);
        for (int slot = 0; slot < 6; ++slot) {
            SampleRecord sample = test::sample_of(header, slot);
            sample.status = slot == 4 ? 1 : 0;
            change(sample);
            writer.write(slot, sample);
        }
        writer.finish();
    }

    /// As another program may write it: whatever the types.
    template <typename Id, typename Real>
    void write_foreign(const std::vector<Id>& id, const std::vector<Real>& value, const Shape& shape) const {
        Hdf5File file = Hdf5File::create(path);
        file.write("/samples/id", id, {static_cast<int64_t>(id.size())});
        file.write("/samples/predicted", value, shape);
        file.close();
    }
    void write_ids(const std::vector<int64_t>& id) const {
        const auto count = static_cast<int64_t>(id.size());
        write_foreign(id, std::vector<float>(9 * id.size(), 0.5f), {count, 3, 3});
    }

    /// What the check says: "what (where) mend", or nothing.
    std::string complaint(const std::vector<int>& splits = {0, 1, 2}) const {
        try {
            check_predictions(PredictionsReader(path), DatasetReader(dataset), splits);
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            EXPECT_NE(error.where(), "");
            return std::string(error.what()) + " | " + error.mend();
        }
    }
    std::string unreadable() const {
        try {
            const PredictionsReader reader(path);
            return "";
        } catch (const Error& error) {
            EXPECT_NE(error.where().find("mine.h5"), std::string::npos);
            return error.what();
        }
    }

    fs::path folder;
    std::string path, dataset;
};

TEST_F(PredictionsFile, ReadsWhatItWrites) {
    const PredictionsHeader header{"ridge", "components = 3\n", "0123456789abcdef0123456789abcdef", "0.1.0"};
    const auto write = [&](const std::string& to) {
        PredictionsWriter writer(to, header, 3, 2);
        writer.write(std::vector<int64_t>{7, 5}, std::vector<float>{1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6});
        writer.write(std::vector<int64_t>{900}, std::vector<float>{0, 0, 0, 0.25f, 0, 0});
        writer.finish();
    };
    write(path);
    const PredictionsReader reader(path);
    EXPECT_EQ(reader.predictor(), "ridge");
    EXPECT_EQ(reader.header().options, header.options);
    EXPECT_EQ(reader.header().dataset_config_hash, header.dataset_config_hash);
    EXPECT_EQ(reader.header().program_version, header.program_version);
    EXPECT_EQ(reader.id(), (std::vector<int64_t>{7, 5, 900}));
    EXPECT_EQ(reader.vertex_count(), 2);
    Positions expected(2, 3);
    expected << -1, -2, -3, -4, -5, -6;
    EXPECT_EQ(reader.read(5), expected);
    EXPECT_EQ(reader.read(std::vector<int64_t>{900, 7}), (std::vector<double>{0, 0, 0, 0.25, 0, 0, 1, 2, 3, 4, 5, 6}));
    EXPECT_FALSE(reader.has(6));
    EXPECT_THROW(reader.read(6), Error);
    const std::string first = bytes_of(path);
    write(path);
    EXPECT_EQ(bytes_of(path), first);
}

TEST_F(PredictionsFile, AppearsWholeOrNotAtAll) {
    {
        PredictionsWriter writer(path, {}, 2, 1);
        writer.write(std::vector<int64_t>{1}, std::vector<float>{0, 0, 0});
        EXPECT_THROW(writer.finish(), Error);
        EXPECT_THROW(writer.write(std::vector<int64_t>{2}, std::vector<float>{0, 0}), Error);
        EXPECT_THROW(writer.write(std::vector<int64_t>{2, 3}, std::vector<float>(6)), Error);
    }
    EXPECT_FALSE(fs::exists(path));
    EXPECT_FALSE(fs::exists(path + ".partial"));
    EXPECT_THROW(PredictionsWriter((folder / "none" / "p.h5").string(), {}, 1, 1), Error);
    EXPECT_THROW(PredictionsWriter(path, {}, 0, 1), Error);
}

TEST_F(PredictionsFile, TakesWhatAnyNetworkMayWrite) {
    write_foreign(std::vector<int32_t>{103, 100}, std::vector<double>(18, 0.125), {2, 3, 3});
    EXPECT_EQ(PredictionsReader(path).predictor(), "mine");
    EXPECT_EQ(PredictionsReader(path).read(103), Positions::Constant(3, 3, 0.125));
    EXPECT_EQ(complaint({0}), "");
    Hdf5File file = Hdf5File::edit(path);
    file.set_attribute("/", "predictor", "my network");
    file.close();
    EXPECT_EQ(PredictionsReader(path).predictor(), "my network");
}

TEST_F(PredictionsFile, SaysWhatKeepsItFromBeingRead) {
    write_foreign(std::vector<float>{1, 2}, std::vector<float>(18), {2, 3, 3});
    EXPECT_EQ(unreadable(), "/samples/id holds float32, expected integers");
    write_foreign(std::vector<int64_t>{1, 2}, std::vector<int32_t>(18), {2, 3, 3});
    EXPECT_EQ(unreadable(), "/samples/predicted holds int32, expected floating point");
    write_foreign(std::vector<int64_t>{1, 2}, std::vector<float>(18), {2, 9});
    EXPECT_EQ(unreadable(), "/samples/predicted has shape (2, 9), expected (N, V, 3)");
    write_foreign(std::vector<int64_t>{1, 2, 3}, std::vector<float>(18), {2, 3, 3});
    EXPECT_EQ(unreadable(), "/samples/predicted holds 2 samples for 3 ids");
    write_ids({1, 2, 1});
    EXPECT_EQ(unreadable(), "sample 1 is predicted twice, at 0 and 2");
    path = (folder / "mine.h5.none").string();
    EXPECT_NE(unreadable(), "");
    path = dataset;
    EXPECT_THROW(PredictionsReader{path}, Error);  // no predictions
}

TEST_F(PredictionsFile, RefusesNamesThatNameNothing) {
    for (const char* name : {"a/b", ".", "two\nlines"}) {
        write_ids({100});
        Hdf5File file = Hdf5File::edit(path);
        file.set_attribute("/", "predictor", name);
        file.close();
        EXPECT_NE(unreadable(), "") << name;
    }
    write_ids({100});
    Hdf5File file = Hdf5File::edit(path);
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", 99);
    file.close();
    EXPECT_EQ(unreadable(), "the file has version 99, and this program reads version 1");
}

TEST_F(PredictionsFile, FitsItsDataSet) {
    write_ids({105, 100, 103, 102, 101});  // 104 was not accepted
    EXPECT_EQ(complaint(), "");
    EXPECT_EQ(accepted_ids(DatasetReader(dataset), {1}), (std::vector<int64_t>{101}));
    EXPECT_EQ(accepted_ids(DatasetReader(dataset), {2, 0}), (std::vector<int64_t>{100, 102, 103, 105}));
}

TEST_F(PredictionsFile, OneDefectAtATimeIsNamed) {
    write_ids({100, 101, 102});
    EXPECT_EQ(complaint({1}), "");
    EXPECT_EQ(complaint(),
              "1 of 2 accepted samples of the split train are not predicted: id 103 | predict them, or choose other "
              "splits with --split");
    write_ids({100, 101, 102, 103, 105, 7});
    EXPECT_EQ(complaint().find("a prediction is of no sample of " + dataset + ": id 7 |"), 0u) << complaint();
    write_ids({});
    EXPECT_EQ(complaint().find("the file holds no predictions"), 0u) << complaint();
    write_foreign(std::vector<int64_t>{100}, std::vector<float>(12), {1, 4, 3});
    EXPECT_EQ(complaint().find("predictions have 4 vertices, the data set 3 |"), 0u) << complaint();
}

TEST_F(PredictionsFile, NumbersThatAreNotFiniteNameTheSample) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<float> value(18, 0.5f);
        value[9 + 4] = bad;
        write_foreign(std::vector<int64_t>{100, 103}, value, {2, 3, 3});
        EXPECT_EQ(complaint({0}).find("the prediction of sample 103 is not finite |"), 0u) << complaint({0});
        write_foreign(std::vector<int64_t>{102, 104}, value, {2, 3, 3});  // 104 is not accepted: nobody looks at it
        EXPECT_NE(complaint({2}).find("are not predicted: id 105 |"), std::string::npos) << complaint({2});
    }
}

TEST_F(PredictionsFile, BelongsToTheDataSetItNames) {
    write_ids({101});
    Hdf5File file = Hdf5File::edit(path);
    file.set_attribute("/", "dataset_config_hash", "ffffffffffffffffffffffffffffffff");
    file.close();
    EXPECT_EQ(complaint({1}).find("the predictions are of another data set"), 0u) << complaint({1});
}

TEST_F(PredictionsFile, ASplitWithoutSamplesIsNamed) {
    write_dataset([](SampleRecord& sample) { sample.split = sample.split == 1 ? 0 : sample.split; });
    write_ids({100, 101, 102, 103, 105});
    EXPECT_EQ(complaint(),
              "the data set has no accepted sample in the split validation | choose with --split from: train, test");
    EXPECT_EQ(complaint({0, 2}), "");
    write_dataset([](SampleRecord& sample) { sample.status = 1; });
    EXPECT_EQ(complaint({0}),
              "the data set has no accepted sample in the split train | it has no accepted sample at all");
}

}  // namespace
}  // namespace toile::files

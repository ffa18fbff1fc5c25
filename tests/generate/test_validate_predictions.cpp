#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "generate/validate.h"
#include "generate/validate_recompute.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;

class ValidatePredictions : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "toile_predictions_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { fs::remove_all(folder); }

    /// Writes the file as the members say and returns what is wrong with it.
    std::vector<std::string> defects(const ValidateOptions& options = {}) {
        const std::string path = (folder / "predictions.h5").string();
        files::Hdf5File file = files::Hdf5File::create(path);
        if (!id.empty()) file.write("/samples/id", id, {static_cast<int64_t>(id.size())});
        file.write("/samples/predicted", predicted, shape);
        file.close();
        const Validation result = validate_file(path, options);
        accepted = result.accepted;
        return result.defect;
    }

    fs::path folder;
    std::vector<int64_t> id{10, 13, 11};
    files::Shape shape{3, 4, 3};
    std::vector<float> predicted = std::vector<float>(36, 0.5f);
    int accepted = 0;
};

TEST_F(ValidatePredictions, AcceptsWhatAnyNetworkMayWrite) {
    EXPECT_TRUE(defects().empty());
    EXPECT_EQ(accepted, 3);
}

TEST_F(ValidatePredictions, FindsOneDefectAtATime) {
    id[2] = 10;
    EXPECT_EQ(defects(), (std::vector<std::string>{"/samples/id[2]: 10 is the id of sample 0 too"}));
    id = {10, 13};
    EXPECT_EQ(defects(), (std::vector<std::string>{"/samples/predicted: holds 3 samples for 2 ids"}));
    id.clear();
    EXPECT_EQ(defects(), (std::vector<std::string>{"/samples/id: missing"}));
    id = {10, 13, 11};
    predicted[12 + 5] = predicted[12 + 7] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(defects(),
              (std::vector<std::string>{"/samples/predicted[1]: vertex 1 is not finite, and 1 more numbers"}));
    EXPECT_EQ(accepted, 2);
    shape = {3, 12};
    EXPECT_EQ(defects(), (std::vector<std::string>{"/samples/predicted: has shape (3, 12), expected (N, V, 3)"}));
}

TEST_F(ValidatePredictions, ComparesWithTheDataSet) {
    ValidateOptions options;
    options.dataset = (folder / "dataset.h5").string();
    TinyDataset().write(options.dataset);
    const int64_t vertices = files::Hdf5File::open(options.dataset).shape("/samples/cloth")[1];
    predicted.assign(static_cast<size_t>(9 * vertices), 0.0f);
    shape = {3, vertices, 3};
    EXPECT_TRUE(defects(options).empty());
    id[1] = 99;
    EXPECT_EQ(defects(options), (std::vector<std::string>{"/samples/id[1]: 99 is no sample of " + options.dataset}));
    id[1] = 13;
    predicted.resize(36);
    shape = {3, 4, 3};
    ASSERT_EQ(defects(options).size(), 1u);
    EXPECT_EQ(defects(options)[0].find("/samples/predicted: has 4 vertices, the data set "), 0u);
    EXPECT_THROW(validate_file(options.dataset, options), Error);  // no predictions
}

TEST(RecomputeChoice, IsAShareOrANumber) {
    EXPECT_DOUBLE_EQ(recompute_choice("1%").share, 0.01);
    EXPECT_DOUBLE_EQ(recompute_choice("0.5 %").share, 0.005);
    EXPECT_EQ(recompute_choice("20").count, 20);
    for (const char* bad : {"", "0", "0%", "101%", "-3", "1.5", "1x", "nan%"})
        EXPECT_THROW(recompute_choice(bad), Error);
}

TEST_F(ValidatePredictions, AreNotMadeAgain) {
    ValidateOptions options;
    options.recompute = RecomputeChoice{};
    EXPECT_THROW(defects(options), Error);
}

TEST_F(ValidatePredictions, SamplesWhoseConfigurationIsGoneCannotBeMadeAgain) {
    const std::string path = (folder / "dataset.h5").string();
    TinyDataset().write(path);  // its configuration is no scene
    ValidateOptions options;
    options.recompute = recompute_choice("1");
    EXPECT_THROW(validate_file(path, options), Error);
}

}  // namespace
}  // namespace toile::generate

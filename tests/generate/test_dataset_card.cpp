#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "cloth/error.h"
#include "files/digest.h"
#include "files/image_file.h"
#include "generate/dataset_card.h"
#include "generate/distribution.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;

TEST(Distribution, IsByNearestRank) {
    std::vector<double> value;
    for (int i = 200; i >= 1; --i) value.push_back(i);
    value.push_back(std::numeric_limits<double>::quiet_NaN());
    const Distribution d = distribution(value);
    EXPECT_EQ(d.smallest, 1);
    EXPECT_EQ(d.first, 2);
    EXPECT_EQ(d.fifth, 10);
    EXPECT_EQ(d.median, 100);
    EXPECT_EQ(d.ninety_fifth, 190);
    EXPECT_EQ(d.ninety_ninth, 198);
    EXPECT_EQ(d.largest, 200);
    EXPECT_EQ(distribution({3, 1, 2}).median, 2);
    EXPECT_EQ(distribution({3, 1, 2}).ninety_ninth, 3);
    EXPECT_EQ(distribution({}).largest, 0);
}

class DatasetCard : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "toile_card_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
        tiny.change_header = [](files::DatasetHeader& header) {
            header.config =
                "[scene]\nname = \"tiny\"\n\n[body]\nlicence = \"CC BY 4.0, someone\"\n\n[garment]\nsource = "
                "\"tshirt\"\n\n[material]\ndensity_per_area = 0.2  # [kg/m^2]\n\n[gate]\nmax_stretch = 2.0\n";
        };
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string card(const CardOptions& options = {}) {
        tiny.write((folder / "dataset.h5").string());
        write_card((folder / "dataset.h5").string(), options);
        std::ifstream file(folder / "CARD.md");
        std::stringstream text;
        text << file.rdbuf();
        return text.str();
    }

    fs::path folder;
    TinyDataset tiny;
};

TEST_F(DatasetCard, SaysWhatTheDataSetHolds) {
    tiny.change_sample = [](int slot, files::SampleRecord& sample) {
        sample.certificate.residual_force = 1e-4 * (slot + 1);
        sample.certificate.seconds = 2.0 * slot;
        sample.certificate.detail->iterations = 10 * (slot + 1);
        sample.status = slot == 1 ? 1 : 0;
    };
    CardOptions options;
    options.command = "toile generate tiny.toml --out out";
    options.remarks = {"the garment was mended"};
    const std::string text = card(options);
    for (const char* line : {
             "# tiny\n",
             "| train | 1 | 1 | 2 |",
             "| validation | 1 | 0 | 1 |",
             "| all | 3 | 1 | 4 |",
             "| not at rest | 1 | 11 |",
             // Of 1, 3 and 4: the accepted.
             "| `residual_force` | of the weight | 0.0003 | 0.0004 | 0.0004 | 0.0004 | 0.001 |",
             "| `iterations` |  | 30 | 40 | 40 | 40 |  |",
             "| `seconds` | s | 4 | 6 | 6 | 6 |  |",
             "| images | 48 x 48 pixels, ",
             "| body | CC BY 4.0, someone |",
             "| garment | not stated |",
             "[material]\ndensity_per_area = 0.2  # [kg/m^2]\n```",
             "| program | toile 0.1.0 |",
             "| command | `toile generate tiny.toml --out out` |",
             "`0123456789abcdef0123456789abcdef`",
             "- the garment was mended",
             "[gate]\nmax_stretch = 2.0\n```",
         })
        EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
    EXPECT_NE(text.find(corpus_digest((folder / "dataset.h5").string())), std::string::npos);
    EXPECT_EQ(text.find("replay/"), std::string::npos);  // there is none
    const files::Picture sheet = files::read_png((folder / "samples.png").string());
    EXPECT_GT(sheet.width, 500);
    // Not a white sheet: cloth and body are on it.
    EXPECT_GT(std::count_if(sheet.value.begin(), sheet.value.end(), [](std::uint8_t v) { return v < 200; }), 5000);
}

TEST_F(DatasetCard, IsTheSameEachTime) {
    const std::string once = card();
    EXPECT_EQ(card(), once);
}

TEST_F(DatasetCard, NamesTheReplays) {
    tiny.change_sample = [](int slot, files::SampleRecord& sample) { sample.status = slot >= 2 ? 1 : 0; };
    fs::create_directory(folder / "replay");
    std::ofstream(folder / "replay" / "pose_000012.h5") << "x";
    const std::string text = card();
    EXPECT_NE(text.find("| not at rest | 2 | 12, 13 |"), std::string::npos) << text;
    EXPECT_NE(text.find("toile simulate --replay replay/pose_000012.h5 --out pose.obj"), std::string::npos);
}

TEST_F(DatasetCard, LeavesOutWhatTheDataSetLacks) {
    const auto with_body = tiny.change_header;
    tiny.change_header = [&](files::DatasetHeader& header) {
        with_body(header);
        header.image.reset();
    };
    tiny.change_sample = [](int, files::SampleRecord& sample) {
        sample.image.clear();
        sample.certificate.detail.reset();
    };
    const std::string text = card();
    EXPECT_EQ(text.find("image"), std::string::npos);
    EXPECT_EQ(text.find("moving_share"), std::string::npos);
    EXPECT_EQ(text.find("## Failures"), std::string::npos);
    EXPECT_NE(text.find("| body | "), std::string::npos);
}

TEST_F(DatasetCard, AllFailedShowsNoPicture) {
    tiny.change_sample = [](int, files::SampleRecord& sample) { sample.status = 1; };
    const std::string text = card();
    EXPECT_EQ(text.find("samples.png"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "samples.png"));
    EXPECT_NE(text.find("| all | 0 | 4 | 4 |"), std::string::npos);
}

TEST_F(DatasetCard, OneDigestForTheWholeInTheOrderOfTheIds) {
    const std::string path = (folder / "dataset.h5").string();
    tiny.write(path);
    std::string all;
    const files::DatasetReader reader(path);
    for (int slot = 0; slot < TinyDataset::samples; ++slot)
        for (const std::uint8_t byte : reader.stored_digest(slot)) all += static_cast<char>(byte);
    EXPECT_EQ(corpus_digest(path), files::text_digest(all));
    EXPECT_THROW(write_card((folder / "none.h5").string()), Error);
}

TEST(DatasetCardSlots, PicksSplitsAndTheWorst) {
    //                         0    1    2    3    4    5    6    7
    const std::vector<int> split{0, 0, 0, 1, 0, 2, 0, 1}, status{0, 0, 0, 0, 0, 0, 0, 1};
    const std::vector<double> stretch{1, 1.2, 1, 1, 1, 1, 1, 9}, depth{0, 0, 0, 0, 0, 0, 1e-5, 9};
    EXPECT_EQ(card_slots(split, status, stretch, depth), (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
    // Of many, few: the first and middle of each split, the worst, and some between.
    std::vector<int> many(1000, 0), good(1000, 0);
    std::vector<double> even(1000, 1.0), deep(1000, 0.0);
    many[10] = 1;
    many[20] = 2;
    even[777] = 1.1;
    deep[333] = 1e-5;
    const std::vector<int> slot = card_slots(many, good, even, deep);
    EXPECT_EQ(slot.size(), 8u);
    for (const int wanted : {0, 10, 20, 333, 501, 777})
        EXPECT_TRUE(std::binary_search(slot.begin(), slot.end(), wanted));
    EXPECT_TRUE(card_slots({0}, {1}, {1}, {0}).empty());
}

}  // namespace
}  // namespace toile::generate

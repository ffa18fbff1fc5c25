#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cloth/error.h"
#include "evaluate/noise_histogram.h"
#include "evaluate/noise_results.h"
#include "evaluate/noise_section.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(NoiseHistogram, CountsEveryDistanceOnce) {
    const std::vector<double> some{0.0, 2e-6, 1.5e-3, 1.6e-3, 0.9}, others{1e9};
    const auto histogram = noise_histogram({{"some", &some}, {"others", &others}});
    const std::vector<double> edges = histogram.at("edges");
    EXPECT_EQ(edges.size(), 5u * 8 + 1);
    EXPECT_DOUBLE_EQ(edges.front(), 1e-4);
    EXPECT_DOUBLE_EQ(edges.back(), 1e4);
    const std::vector<double> counts = histogram.at("series").at(0).at("counts");
    ASSERT_EQ(counts.size() + 1, edges.size());
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0.0), 5.0);
    EXPECT_EQ(counts.front(), 1.0) << "a distance of zero";
    for (size_t k = 1; k < counts.size(); ++k) {
        const auto inside = [&](double distance) {
            return 1e3 * distance >= edges[k] && 1e3 * distance < edges[k + 1];
        };
        EXPECT_EQ(counts[k], std::count_if(some.begin(), some.end(), inside)) << k;
    }
    EXPECT_EQ(histogram.at("series").at(1).at("counts").back(), 1) << "beyond the last edge";
    EXPECT_TRUE(noise_histogram({{"none", &others}, {"empty", &some}}).at("edges").size() > 1);
    const std::vector<double> nothing;
    EXPECT_TRUE(noise_histogram({{"nothing", &nothing}}).at("edges").empty());
}

class NoiseSection : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_noise_section_" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// The results of one sample, whose distances are given [m].
    void write(double distance, int status = 0) const {
        const std::vector<files::NoiseVariant> variants{{"half_step", "half the step"}};
        NoiseResults results(variants);
        files::NoiseRecord record;
        record.status = status;
        record.cloth = Positions::Zero(3, 3);
        record.variant = {{0, record.cloth, Eigen::VectorXd::Constant(3, distance)}};
        record.spread = Eigen::VectorXd::Constant(3, status == 0 ? distance : std::nan(""));
        results.add(record, {1.0, 2.0});
        NoiseSummary summary;
        results.summarise(summary);
        summary.poses = 4;
        summary.samples = 1;
        summary.results = (folder_ / "noise.json").string();
        files::NoiseHeader header;
        header.variant = variants;
        summary.missing = {"second_solver: not available"};
        results.write(summary, header, {});
    }
    fs::path folder_;
};

TEST_F(NoiseSection, IsMadeOfWhatWasMeasured) {
    write(2e-3);
    const std::optional<ReportSection> section = noise_section(folder_.string());
    ASSERT_TRUE(section);
    EXPECT_EQ(section->id, "noise");
    EXPECT_NO_THROW(as_json(*section));
    ASSERT_EQ(section->text.size(), 3u);
    EXPECT_THAT(section->text[1], HasSubstr("median of 2 mm"));
    EXPECT_THAT(section->text[2], HasSubstr("second_solver"));
    ASSERT_EQ(section->blocks.size(), 2u);
    const auto& table = std::get<ReportTable>(section->blocks[0]);
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(std::get<std::string>(table.rows[0][0].value()), "half_step");
    EXPECT_DOUBLE_EQ(std::get<double>(table.rows[0][4].value()), 2.0);
    const auto& histogram = std::get<ReportHistogram>(section->blocks[1]);
    EXPECT_EQ(histogram.series.size(), 2u);
}

TEST_F(NoiseSection, SaysWhereNothingRested) {
    write(2e-3, 1);
    const std::optional<ReportSection> section = noise_section(folder_.string());
    ASSERT_TRUE(section);
    EXPECT_NO_THROW(as_json(*section));
    EXPECT_THAT(section->text[1], HasSubstr("no noise floor"));
    EXPECT_EQ(section->blocks.size(), 1u);
}

TEST_F(NoiseSection, IsNotThereWithoutAFileAndRefusesADamagedOne) {
    EXPECT_FALSE(noise_section(folder_.string()));
    write(2e-3);
    std::ifstream stream(folder_ / "noise.json");
    auto document = nlohmann::ordered_json::parse(stream);
    document.erase("variants");
    std::ofstream(folder_ / "noise.json") << document;
    EXPECT_THROW(noise_section(folder_.string()), Error);
    std::ofstream(folder_ / "noise.json") << "{}";
    EXPECT_THROW(noise_section(folder_.string()), Error);
}

}  // namespace
}  // namespace toile::evaluate

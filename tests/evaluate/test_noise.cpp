#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth/error.h"
#include "evaluate/noise.h"
#include "evaluate/noise_results.h"
#include "evaluate/noise_source.h"
#include "files/metric_file.h"
#include "files/noise_file.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(DrawnShare, HoldsAtLeastOneAndNests) {
    EXPECT_EQ(drawn_share(7, 1e-9, 3).size(), 1u);
    EXPECT_EQ(drawn_share(10, 0.3, 3).size(), 3u);
    EXPECT_EQ(drawn_share(11, 0.3, 3).size(), 4u) << "rounded up";
    EXPECT_EQ(drawn_share(5, 1.0, 3), (std::vector<int>{0, 1, 2, 3, 4}));
    const std::vector<int> small = drawn_share(100, 0.1, 5), large = drawn_share(100, 0.4, 5);
    EXPECT_TRUE(std::is_sorted(large.begin(), large.end()));
    EXPECT_TRUE(std::includes(large.begin(), large.end(), small.begin(), small.end()));
    EXPECT_NE(drawn_share(100, 0.1, 6), small) << "another seed";
}

TEST(NoiseVariants, ChangeWhatTheyAreNamedFor) {
    generate::SceneConfig config;
    const std::vector<NoiseVariant> variant = noise_variants(config);
    ASSERT_EQ(variant.size(), 3u);
    EXPECT_EQ(variant[0].config.solver.time_step, 0.5 * config.solver.time_step);
    EXPECT_EQ(variant[0].config.path.joint_step, 0.5 * config.path.joint_step);
    EXPECT_EQ(variant[0].config.solver.residual_tolerance, config.solver.residual_tolerance);
    EXPECT_EQ(variant[1].config.solver.residual_tolerance, 0.1 * config.solver.residual_tolerance);
    EXPECT_EQ(variant[1].config.solver.time_step, config.solver.time_step);
    EXPECT_EQ(variant[2].config.solver.solver, "xpbd");
    config.solver.solver = "xpbd";
    EXPECT_EQ(noise_variants(config)[2].config.solver.solver, "implicit");
}

files::NoiseRecord record_of(int status, int variant_status, double distance) {
    files::NoiseRecord record;
    record.status = status;
    record.cloth = Positions::Zero(3, 3);
    record.variant = {{variant_status, Positions::Zero(3, 3), Eigen::VectorXd::Constant(3, distance)}};
    record.spread = record.variant[0].distance;
    record.spread_rms = record.spread_max = distance;
    return record;
}

TEST(NoiseResults, CountOnlyPairsThatBothRest) {
    const std::vector<files::NoiseVariant> variants{{"half_step", "half"}};
    NoiseResults results(variants);
    for (const auto& [status, variant, distance] :
         {std::tuple{0, 0, 1e-3}, {0, 0, 3e-3}, {0, 0, 2e-3}, {1, 0, 9.0}, {0, 1, 9.0}}) {
        files::NoiseRecord record = record_of(status, variant, distance);
        if (status != 0 || variant != 0) record.spread.setConstant(std::nan(""));
        results.add(record, {1.0, 2.0});
    }
    NoiseSummary summary;
    results.summarise(summary);
    ASSERT_EQ(summary.variant.size(), 1u);
    EXPECT_EQ(summary.configured, 4);
    EXPECT_EQ(summary.variant[0].accepted, 4);
    EXPECT_EQ(summary.variant[0].samples, 3);
    EXPECT_DOUBLE_EQ(summary.variant[0].median, 2e-3);
    EXPECT_DOUBLE_EQ(summary.variant[0].largest, 3e-3);
    EXPECT_DOUBLE_EQ(summary.spread.root_mean_square, std::sqrt(14.0 / 3.0) * 1e-3);
    EXPECT_DOUBLE_EQ(summary.variant[0].seconds, 2.0);
    EXPECT_THAT(noise_table(summary), HasSubstr("2.0000"));
}

/// A hanging patch: one sample, seconds even in a debug build.
class Noise : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_noise_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        std::ofstream(folder_ / "patch.toml")
            << "[garment]\nsource = \"patch\"\nwidth = 0.3\nheight = 0.3\nedge_length = 0.06\n[bending]\n"
               "[pins]\ncorners = \"top\"\n";
    }
    void TearDown() override { fs::remove_all(folder_); }

    NoiseOptions options() const {
        NoiseOptions options;
        options.source = (folder_ / "patch.toml").string();
        options.folder = (folder_ / "out").string();
        return options;
    }
    fs::path folder_;
};

TEST_F(Noise, StoresTheSpreadOfItsVariants) {
    const NoiseSummary summary = measure_noise(options());
    EXPECT_EQ(summary.samples, 1);
    EXPECT_EQ(summary.configured, 1);
    const files::NoiseReader file(summary.file);
    ASSERT_EQ(file.sample_count(), 1);
    EXPECT_EQ(file.header().variant.size() + file.header().missing.size(), 3u);
    const files::NoiseRecord record = file.read(0);
    EXPECT_EQ(record.cloth, file.header().mesh.rest_position) << "the scene has no poses: its neutral drape";
    for (const auto& one : record.variant)
        EXPECT_LT(((one.cloth - record.cloth).rowwise().norm() - one.distance).cwiseAbs().maxCoeff(), 1e-6)
            << "cloth is stored in single precision";
    for (Eigen::Index v = 0; v < record.spread.size(); ++v) {
        double largest = 0.0;
        for (const auto& one : record.variant)
            if (one.status == 0) largest = std::max(largest, one.distance[v]);
        EXPECT_EQ(record.spread[v], largest);
    }
    EXPECT_GT(record.spread_max, 0.0) << "another step never gives the same bits";
    EXPECT_LT(record.spread_max, 0.02) << "but the same cloth";
    EXPECT_EQ(record.spread_max, record.spread.maxCoeff());
    EXPECT_NEAR(summary.spread.largest, record.spread_max, 1e-15);
}

TEST_F(Noise, WritesItsResultsForAReport) {
    const NoiseSummary summary = measure_noise(options());
    std::ifstream stream(summary.results);
    const auto json = nlohmann::json::parse(stream);
    EXPECT_EQ(json.at("format"), "toile metrics");
    EXPECT_EQ(json.at("kind"), "noise");
    const files::MetricFile metrics = files::read_metric_file(summary.results, "noise");
    const auto spread = std::find_if(metrics.metric.begin(), metrics.metric.end(),
                                     [](const files::Metric& one) { return one.name == "noise/spread/distance"; });
    ASSERT_NE(spread, metrics.metric.end());
    EXPECT_DOUBLE_EQ(spread->value, 1e3 * summary.spread.root_mean_square);
    EXPECT_EQ(spread->unit, "mm");
    ASSERT_TRUE(spread->distribution);
    EXPECT_DOUBLE_EQ(spread->distribution->largest, 1e3 * summary.spread.largest);
    EXPECT_EQ(json.at("samples").size(), 1u);
    EXPECT_EQ(json.at("samples").at(0).at("status"), "accepted");
    EXPECT_DOUBLE_EQ(json.at("spread").at("largest"), summary.spread.largest);
}

TEST_F(Noise, RefusesOneDefectAtATime) {
    NoiseOptions wrong = options();
    wrong.share = 0.0;
    EXPECT_THROW(measure_noise(wrong), Error);
    wrong.share = 1.5;
    EXPECT_THROW(measure_noise(wrong), Error);
    wrong = options();
    wrong.jobs = 0;
    EXPECT_THROW(measure_noise(wrong), Error);
    wrong = options();
    wrong.source = "absent.h5";
    EXPECT_THROW(measure_noise(wrong), Error);
    wrong = options();
    wrong.folder = wrong.source;
    EXPECT_THROW(measure_noise(wrong), Error);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace toile::evaluate

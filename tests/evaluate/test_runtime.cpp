#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "cloth/error.h"
#include "evaluate/prior_study.h"
#include "evaluate/runtime.h"
#include "evaluate/runtime_results.h"
#include "evaluate/runtime_section.h"
#include "files/predictions_file.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Each look at the clock is a second after the one before: everything takes one.
Clock ticking() {
    return [now = 0.0]() mutable { return now += 1.0; };
}

class Runtime : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_runtime_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        generate::TinyDataset().write(path("dataset.h5"));
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    RuntimeSamples samples(int count = 2) const { return read_runtime_samples(path("dataset.h5"), count, {}); }
    RuntimeOptions options(const std::vector<std::string>& studies) const {
        RuntimeOptions all;
        all.dataset = path("dataset.h5");
        all.folder = path("out");
        all.studies = studies;
        all.quick = true;
        all.clock = all.wall = ticking();
        return all;
    }
    void expect_refused(const RuntimeOptions& bad, const std::string& words) const {
        try {
            evaluate_runtime(bad);
            FAIL() << "nothing was wrong";
        } catch (const Error& error) {
            EXPECT_THAT(error.what() + (" " + error.where()), HasSubstr(words));
        }
        EXPECT_FALSE(fs::exists(path("out"))) << "nothing is left behind";
    }

    fs::path folder_;
};

const StudySeries& series_of(const StudyCurves& curves, const std::string& name) {
    for (const StudySeries& one : curves.series)
        if (one.name == name) return one;
    throw Error("there is no series " + name);
}

TEST_F(Runtime, DrawsTheSameSamplesAndNoiseFromASeed) {
    const RuntimeSamples one = samples(2), again = samples(2), more = samples(3);
    ASSERT_EQ(one.count(), 2);
    EXPECT_EQ(one.predicted, again.predicted);
    std::set<std::int64_t> all;
    for (const files::SampleRecord& record : more.record) all.insert(record.id);
    for (const files::SampleRecord& record : one.record) EXPECT_TRUE(all.count(record.id)) << "a larger draw holds it";
    EXPECT_EQ(samples(100).count(), one.accepted);
    double sum = 0.0;
    for (size_t k = 0; k < one.target[0].size(); ++k) sum += std::pow(one.predicted[0][k] - one.target[0][k], 2);
    EXPECT_NEAR(std::sqrt(sum / one.vertex_count()), 0.005, 0.001);
    const RuntimeSamples other = read_runtime_samples(path("dataset.h5"), 4, {"", 0.005, 2});
    EXPECT_NE(other.predicted[0], samples(4).predicted[0]) << "another seed";
}

TEST_F(Runtime, PriorsComeNearerToTheirReferenceWithTheTolerance) {
    const PriorSweep sweep{{1e-2, 1e-5, 1e-8}, {1, 4, 1000}};
    const Study study = study_priors(samples(), sweep, {.rounds = 2}, ticking());
    EXPECT_THAT(study.left_out, IsEmpty());
    EXPECT_EQ(study.refused, 0);
    ASSERT_EQ(study.curves.size(), 3u);
    ASSERT_EQ(study.curves[0].series.size(), 5u);
    for (const char* name :
         {"inextensibility/interior_point", "inextensibility/cone", "quasistatic/fast", "quasistatic/newton_cg"}) {
        const std::vector<StudyPoint>& point = series_of(study.curves[0], name).point;
        ASSERT_EQ(point.size(), 3u) << name;
        EXPECT_LT(point[2].y.middle, 1e-3) << name << ": a micrometre, in millimetres";
        EXPECT_LE(point[2].y.middle, point[0].y.middle) << name;
        EXPECT_EQ(point[0].x.middle, 1.0) << name << ": the clock's second";
        EXPECT_EQ(point[0].label, "tolerance 1e-02");
    }
    const std::vector<StudyPoint>& sweeps = series_of(study.curves[0], "position-based sweeps").point;
    const std::vector<StudyPoint>& stretch = series_of(study.curves[2], "position-based sweeps").point;
    ASSERT_EQ(sweeps.size(), 3u);
    EXPECT_LT(stretch[2].y.middle, 0.01 * stretch[0].y.middle) << "the sweeps take the stretch out";
    EXPECT_GT(sweeps[2].y.middle, 0.01) << "but do not come to the nearest cloth";
    EXPECT_EQ(study.curves[2].series.size(), 3u) << "the quasistatic prior has no limits to exceed";
    ASSERT_EQ(study.table.size(), 1u);
    EXPECT_EQ(study.table[0].row.size(), 15u);
    for (const auto& row : study.table[0].row) EXPECT_EQ(row.size(), study.table[0].column.size());
}

TEST_F(Runtime, GradientsComeNearerToThatOfTheReference) {
    const Study study = study_gradients(samples(), {{1e-2, 1e-8}, {}}, {.rounds = 1}, ticking());
    ASSERT_EQ(study.curves.size(), 1u);
    ASSERT_EQ(study.curves[0].series.size(), 4u);
    for (const StudySeries& one : study.curves[0].series) {
        ASSERT_EQ(one.point.size(), 2u) << one.name;
        EXPECT_LT(one.point[1].y.middle, 1e-3) << one.name;
        EXPECT_LE(one.point[1].y.middle, one.point[0].y.middle) << one.name;
    }
}

TEST_F(Runtime, LeavesRuntimeJsonThatTheReportReads) {
    const RuntimeSummary summary = evaluate_runtime(options({"image", "priors"}));
    ASSERT_EQ(summary.study.size(), 2u);
    EXPECT_EQ(summary.study[0].name, "priors") << "in the order they have, whatever was asked first";
    const files::MetricFile file = files::read_metric_file(path("out/runtime.json"), "runtime");
    std::set<std::string> name;
    for (const files::Metric& one : file.metric) name.insert(one.name);
    for (const char* one :
         {"runtime/priors/inextensibility/interior_point@1e-06/time_ratio", "runtime/priors/quasistatic/fast@1e-06/rms",
          "runtime/priors/position_projection@sweeps=512/overstretch", "runtime/image/32px/rms"})
        EXPECT_TRUE(name.count(one)) << one;
    for (const files::Metric& one : file.metric) {
        if (one.unit == "s") {
            EXPECT_EQ(one.direction, files::MetricDirection::none) << one.name;
        }
    }
    std::set<std::string> about;
    for (const files::MetricFile::Line& line : file.about) about.insert(line.name);
    for (const char* one : {"dataset", "processor", "cores", "load_at_start"}) EXPECT_TRUE(about.count(one)) << one;
    EXPECT_THAT(runtime_table(summary), HasSubstr("inextensibility/cone"));
}

TEST_F(Runtime, SectionHoldsTheCurvesAndTables) {
    EXPECT_FALSE(runtime_section(path("")).has_value()) << "there is no runtime.json yet";
    const RuntimeSummary summary = evaluate_runtime(options({"priors"}));
    const std::optional<ReportSection> section = runtime_section(path("out"));
    ASSERT_TRUE(section);
    EXPECT_EQ(section->id, "runtime");
    ASSERT_EQ(section->blocks.size(), 4u);
    const auto& curves = std::get<ReportCurves>(section->blocks[0]);
    EXPECT_TRUE(curves.x.log && curves.y.log);
    const StudyCurves& measured = summary.study[0].curves[0];
    ASSERT_EQ(curves.series.size(), measured.series.size());
    EXPECT_DOUBLE_EQ(curves.series[0].points[0].y, measured.series[0].point[0].y.middle);
    EXPECT_DOUBLE_EQ(curves.series[0].points[0].y_high, measured.series[0].point[0].y.high);
    const auto& table = std::get<ReportTable>(section->blocks[3]);
    EXPECT_EQ(table.rows.size(), summary.study[0].table[0].row.size());
    EXPECT_EQ(table.columns[0].align, ReportColumn::Align::text);
    EXPECT_EQ(table.columns[2].align, ReportColumn::Align::number);
    EXPECT_NO_THROW(as_json(*section));
}

TEST_F(Runtime, SectionRefusesDamage) {
    evaluate_runtime(options({"image"}));
    nlohmann::ordered_json document;
    std::ifstream(path("out/runtime.json")) >> document;
    const auto refused = [&](const nlohmann::ordered_json& damaged) {
        std::ofstream(path("out/runtime.json")) << damaged.dump();
        EXPECT_THROW(runtime_section(path("out")), Error);
    };
    nlohmann::ordered_json damaged = document;
    damaged["version"] = 99;
    refused(damaged);
    damaged = document;
    damaged["study"] = "lost";
    refused(damaged);
    damaged = document;
    damaged["study"][0].erase("curves");
    refused(damaged);
    damaged = document;
    damaged["study"][0]["table"][0]["row"][0].push_back("one cell too many");
    refused(damaged);
}

TEST_F(Runtime, SaysWhatDoesNotApply) {
    // This data set's configuration describes no scene that could be built again.
    const RuntimeSummary summary = evaluate_runtime(options({"solvers", "mesh"}));
    for (const Study& one : summary.study) {
        EXPECT_EQ(one.left_out.size(), 1u) << one.name;
        EXPECT_TRUE(one.metric.empty()) << one.name;
    }
    EXPECT_EQ(summary.refused(), 0) << "nothing failed";
    EXPECT_THAT(runtime_table(summary), HasSubstr("left out"));
}

TEST_F(Runtime, RefusesWhatItCannotMeasure) {
    expect_refused(options({"priors", "nothing"}), "there is no study \"nothing\"");
    RuntimeOptions bad = options({"priors"});
    bad.dataset = path("nowhere.h5");
    expect_refused(bad, "nowhere.h5");
    generate::TinyDataset rejected;
    rejected.change_sample = [](int, files::SampleRecord& sample) { sample.status = 1; };
    rejected.write(path("rejected.h5"));
    bad.dataset = path("rejected.h5");
    expect_refused(bad, "no accepted sample");
    std::ofstream(path("file")) << "in the way";
    bad = options({"priors"});
    bad.folder = path("file/out");
    expect_refused(bad, "file");
}

TEST_F(Runtime, TakesPredictionsOfSomeSamples) {
    const RuntimeSamples all = samples(4);
    const int vertices = all.vertex_count();
    const auto write = [&](std::int64_t id, int count, float shift) {
        files::PredictionsWriter writer(path("p.h5"), {"mine", "", "", ""}, 1, count);
        const std::vector<float> r(static_cast<size_t>(3 * count), shift);
        writer.write(std::vector<std::int64_t>{id}, r);
        writer.finish();
    };
    write(all.record[1].id, vertices, 0.25f);
    const RuntimeSamples one = read_runtime_samples(path("dataset.h5"), 4, {path("p.h5")});
    ASSERT_EQ(one.count(), 1);
    EXPECT_EQ(one.record[0].id, all.record[1].id);
    EXPECT_EQ(one.predicted[0][0], 0.25);
    EXPECT_THAT(one.predictions, HasSubstr("mine"));

    RuntimeOptions bad = options({"priors"});
    bad.predictions.file = path("p.h5");
    write(all.record[1].id, vertices + 1, 0.0f);
    expect_refused(bad, "vertices");
    write(987654, vertices, 0.0f);
    expect_refused(bad, "none of the data set's accepted samples");
    write(all.record[1].id, vertices, std::nanf(""));
    expect_refused(bad, "not finite");
}

}  // namespace
}  // namespace toile::evaluate

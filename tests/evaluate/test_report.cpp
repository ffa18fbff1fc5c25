#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/report.h"
#include "evaluate/report_facts.h"
#include "tests/evaluate/evaluated_folder.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

class Report : public testing::Test {
  protected:
    ReportSummary make(const std::string& baseline = {}) {
        return write_report({folder_.path(), baseline, "toile report x",
                             "<!doctype html><!--TOILE_DATA--><main></main><!--TOILE_BLOBS-->"});
    }
    /// The data that the page reads.
    Json page_data() const {
        const std::string page = folder_.text("report.html");
        const size_t begin = page.find("id=\"data\">") + 10;
        return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
    }
    void expect_refused(const std::string& what, const std::string& baseline = {}) {
        try {
            make(baseline);
            FAIL() << what;
        } catch (const Error& error) {
            EXPECT_THAT(error.what() + error.where() + error.mend(), HasSubstr(what));
        }
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            EXPECT_FALSE(entry.path().filename().string().starts_with("report.html") ||
                         entry.path().filename().string().starts_with("results."))
                << entry.path();
    }

    EvaluatedFolder folder_;
};

TEST_F(Report, writes_the_page_and_every_metric) {
    folder_.write();
    folder_.write_arrays();
    const ReportSummary summary = make();
    EXPECT_THAT(summary.evaluations, testing::ElementsAre("accuracy", "runtime", "stability"));
    EXPECT_EQ(summary.metrics, 10u);
    EXPECT_EQ(summary.shown, 2u);
    EXPECT_GT(summary.shown_bytes, 0u);
    EXPECT_EQ(summary.page_bytes, std::filesystem::file_size(summary.page));
    EXPECT_FALSE(summary.baseline);
    const Json data = page_data();
    EXPECT_EQ(data.at("title"), "toile report: shirt.h5");
    EXPECT_EQ(data.at("verdict"), Json(summary.verdict));
    EXPECT_EQ(data.at("scene").at("samples").size(), 2u);
    const files::MetricFile results = files::read_metric_file(summary.results, "results");
    EXPECT_EQ(results.metric.size(), 10u);
    const std::string csv = folder_.text("results.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
}

TEST_F(Report, blobs_of_the_scene_are_in_the_page) {
    folder_.write();
    folder_.write_arrays();
    make();
    const std::string page = folder_.text("report.html");
    EXPECT_THAT(page, HasSubstr("<script type=\"application/octet-stream\" id=\"blob-0\">"));
    const Json scene = page_data().at("scene");
    for (const Json& sample : scene.at("samples"))
        for (const auto& cloth : sample.at("cloth").items())
            EXPECT_THAT(page, HasSubstr("id=\"" + cloth.value().at("position").at("blob").get<std::string>() + "\""));
}

TEST_F(Report, a_scene_is_shown_somewhere) {
    folder_.write();
    folder_.write_arrays();
    make();
    int viewers = 0;
    const Json data = page_data();
    for (const Json& section : data.at("sections"))
        for (const Json& block : section.at("blocks")) viewers += block.at("type") == "viewer";
    EXPECT_EQ(viewers, 1);
}

TEST_F(Report, is_made_of_what_is_there) {
    folder_.write();
    std::filesystem::remove(folder_.file("accuracy.json"));
    std::filesystem::remove(folder_.file("stability.json"));
    const ReportSummary summary = make();
    EXPECT_THAT(summary.evaluations, testing::ElementsAre("runtime"));
    EXPECT_EQ(page_data().at("scene"), nullptr);
}

TEST_F(Report, hostile_names_stay_data) {
    folder_.accuracy.about[0].value = "</script><img src=x onerror=alert(1)>.h5";
    folder_.write();
    make();
    EXPECT_THAT(folder_.text("report.html"), testing::Not(HasSubstr("<img")));
    EXPECT_EQ(page_data().at("facts").at(0).at("value"), folder_.accuracy.about[0].value);
}

TEST_F(Report, numbers_that_are_none_are_null) {
    folder_.accuracy.metric[0].value = std::nan("");
    folder_.write();
    make();
    const Json results = Json::parse(folder_.text("results.json"));
    EXPECT_EQ(results.at("metric").at(0).at("value"), nullptr);
    EXPECT_EQ(page_data().at("verdict").at(0), "Error: no predictor was judged.");
}

TEST_F(Report, the_gate_trips_on_worse_and_on_slower_alone) {
    folder_.write();
    make();
    const std::string baseline = folder_.file("baseline.json");
    std::filesystem::copy(folder_.file("results.json"), baseline);
    EXPECT_FALSE(make(baseline).baseline->trips()) << "the same";

    folder_.accuracy.metric[1].value = 5.0;
    folder_.runtime.metric[4].value = 10.0;
    folder_.write();
    EXPECT_FALSE(make(baseline).baseline->trips()) << "better";

    folder_.accuracy.metric[1].value = 6.1 + 0.27;  // both intervals have half widths of 0.2 mm
    folder_.runtime.metric[4].value = 20.7;         // 0.5 each
    folder_.write();
    EXPECT_FALSE(make(baseline).baseline->trips()) << "within the noise";

    folder_.accuracy.metric[1].value = 6.1 + 0.3;
    folder_.write();
    EXPECT_THAT(make(baseline).baseline->lines(),
                testing::ElementsAre(HasSubstr("inextensibility@limit=0/sqrt_mse: 6.4 mm, baseline 6.1 mm")));

    folder_.accuracy.metric[1].value = 6.1;
    folder_.runtime.metric[4].value = 21.0;
    folder_.write();
    EXPECT_THAT(make(baseline).baseline->lines(), testing::ElementsAre(HasSubstr("time_ratio: 21 ratio, baseline 20")));
    EXPECT_EQ(page_data().at("sections").at(0).at("id"), "baseline");

    std::filesystem::remove(folder_.file("runtime.json"));
    EXPECT_THAT(make(baseline).baseline->lines(), testing::ElementsAre(HasSubstr("time_ratio: not measured")));
}

TEST_F(Report, a_baseline_of_another_version_or_of_others_is_refused) {
    folder_.write();
    const std::string baseline = folder_.file("baseline.json");
    expect_refused("there is no such file", baseline);
    std::ofstream(baseline) << "{}";
    expect_refused("format", baseline);
    std::ofstream(baseline) << R"({"format": "toile metrics", "version": 7})";
    expect_refused("version 7; this program reads version 1", baseline);
    expect_refused("this must be \"results\"", folder_.file("accuracy.json"));
}

TEST_F(Report, a_folder_without_results_is_refused_with_a_mend) {
    expect_refused("no evaluation has left results");
    expect_refused("toile evaluate accuracy|runtime|stability|strain|noise");
    EXPECT_THROW(write_report({folder_.file("absent"), "", "", ""}), Error);
}

TEST_F(Report, damaged_results_are_refused) {
    folder_.write();
    std::ofstream(folder_.file("runtime.json")) << "{\"format\"";
    expect_refused("runtime.json");
    folder_.write();
    std::ofstream(folder_.file("accuracy.h5")) << "no HDF5";
    expect_refused("accuracy.h5");
}

TEST_F(Report, an_earlier_report_stays_where_a_new_one_is_refused) {
    folder_.write();
    make();
    const std::string before = folder_.text("report.html");
    std::ofstream(folder_.file("runtime.json")) << "{";
    EXPECT_THROW(make(), Error);
    EXPECT_EQ(folder_.text("report.html"), before);
}

TEST_F(Report, facts_are_told_once_where_all_agree_and_with_their_kind_else) {
    folder_.write();
    const std::vector<files::MetricFile> evaluations{folder_.accuracy, folder_.runtime};
    std::string text;
    for (const ReportFact& fact : report_facts(evaluations, read_accuracy_document(folder_.file("accuracy.json"))))
        text += fact.name + "=" + fact.value + ";";
    EXPECT_EQ(text,
              "data set=shirt.h5;configuration hash=12ab;samples judged=test 50 of 52;vertices, accuracy=4;"
              "vertices, runtime=2974;command, accuracy=toile evaluate accuracy;");
}

}  // namespace
}  // namespace toile::evaluate

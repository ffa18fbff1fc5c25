#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "files/metric_file.h"
#include "tests/app/cli_runner.h"

namespace toile::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CliReport : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        std::filesystem::create_directory(path("out"));
        measure(2.0, 10.0);
    }
    /// Leaves the results of an evaluation in out.
    void measure(double error, double seconds) {
        files::MetricFile file;
        file.kind = "runtime";
        file.about = {{"dataset", "</script>.h5"}};
        file.metric = {metric("runtime/priors/a@1e-06/rms", error, "mm"),
                       metric("runtime/priors/a@1e-06/time_ratio", seconds, "ratio")};
        files::write_metric_file(path("out/runtime.json"), file,
                                 nlohmann::ordered_json{{"study", nlohmann::ordered_json::array()}});
    }
    static files::Metric metric(const std::string& name, double value, const std::string& unit) {
        files::Metric one;
        one.name = name;
        one.value = value;
        one.unit = unit;
        one.direction = files::MetricDirection::lower;
        one.tolerance = 0.1;
        return one;
    }
    std::string text_of(const std::string& name) const {
        std::ostringstream text;
        text << std::ifstream(path(name), std::ios::binary).rdbuf();
        return text.str();
    }
};

TEST_F(CliReport, ExplainsItself) {
    const Outcome outcome = run("report --help");
    EXPECT_EQ(outcome.status, 0);
    for (const char* word : {"  toile report", "--baseline", "--gate", "report.html", "results.json", "results.csv"})
        EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST_F(CliReport, WritesPageResultsAndTable) {
    const Outcome outcome = run("report out");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* name : {"out/report.html", "out/results.json", "out/results.csv"}) {
        EXPECT_THAT(outcome.out, HasSubstr(name));
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    }
    EXPECT_THAT(outcome.out, HasSubstr("Error: not measured"));
    EXPECT_THAT(text_of("out/results.csv"), HasSubstr("\nruntime/priors/a@1e-06/rms,2,2,2,mm,lower,0.1,0,,,,,\n"));
}

TEST_F(CliReport, ThePageAsksForNothing) {
    ASSERT_EQ(run("report out").status, 0);
    const std::string page = text_of("out/report.html");
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    for (const char* outward : {"<link ", "<iframe", "<script src", "src=\"http", "src='http", "src=\"//",
                                "href=\"http", "href='http", "@import", "url(http", "url(\"http", "url(//"})
        EXPECT_EQ(page.find(outward), std::string::npos) << outward;
    EXPECT_THAT(page, HasSubstr("\\u003c/script>.h5")) << "a name stays data";
}

TEST_F(CliReport, TheGateListsEachMetricThatIsWorseOrMissing) {
    ASSERT_EQ(run("report out").status, 0);
    std::filesystem::copy(path("out/results.json"), path("baseline.json"));
    Outcome outcome = run("report out --baseline baseline.json --gate");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("no regression"));

    measure(1.0, 5.0);
    EXPECT_EQ(run("report out --baseline baseline.json --gate").status, 0) << "better";
    measure(2.1, 10.5);
    EXPECT_EQ(run("report out --baseline baseline.json --gate").status, 0) << "within the tolerance";

    measure(2.5, 10.0);
    outcome = run("report out --baseline baseline.json --gate");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.err_lines(),
                ElementsAre("runtime/priors/a@1e-06/rms: 2.5 mm, baseline 2 mm, worse by 0.5, allowed 0.2"));
    EXPECT_EQ(run("report out --baseline baseline.json").status, 0) << "no gate was asked for";

    measure(2.0, 12.0);
    outcome = run("report out --baseline baseline.json --gate");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.err_lines(), ElementsAre(HasSubstr("time_ratio: 12 ratio")));

    files::MetricFile less = files::read_metric_file(path("out/runtime.json"));
    less.metric = {metric("runtime/priors/a@1e-06/rms", 2.0, "mm")};
    files::write_metric_file(path("out/runtime.json"), less,
                             nlohmann::ordered_json{{"study", nlohmann::ordered_json::array()}});
    outcome = run("report out --baseline baseline.json --gate");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.err_lines(), ElementsAre(HasSubstr("time_ratio: not measured")));
    EXPECT_TRUE(std::filesystem::exists(path("out/report.html"))) << "a gate that trips has its report";
}

TEST_F(CliReport, RefusesWhatItCannotReport) {
    std::filesystem::create_directory(path("empty"));
    write("other.json", "{\"metrics\": []}");
    write("newer.json", "{\"format\": \"toile metrics\", \"version\": 2}");
    std::filesystem::create_directory(path("damaged"));
    std::filesystem::create_directory(path("foreign"));
    write("damaged/accuracy.json", "{\"format\": \"toile me");
    write("foreign/noise.json", "{\"format\": \"toile metrics\", \"version\": 1, \"kind\": \"strain\"}");
    expect_refused("report", "folder");
    expect_refused("report nowhere", "nowhere");
    expect_refused("report other.json", "other.json");
    expect_refused("report empty", "empty");
    expect_refused("report damaged", "damaged/accuracy.json");
    expect_refused("report foreign", "foreign/noise.json:kind");
    expect_refused("report out --gate", "--baseline");
    expect_refused("report out --baseline none.json", "none.json");
    expect_refused("report out --baseline other.json", "other.json:format");
    expect_refused("report out --baseline newer.json", "newer.json:version");
    expect_refused("report out --baseline out/runtime.json", "out/runtime.json:kind");
}

}  // namespace
}  // namespace toile::app

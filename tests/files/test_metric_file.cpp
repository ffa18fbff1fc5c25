#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/metric_file.h"

namespace toile::files {
namespace {

using Json = nlohmann::ordered_json;

class MetricFileTest : public testing::Test {
  protected:
    void SetUp() override {
        path_ = (std::filesystem::temp_directory_path() / ("toile_metric_" + std::to_string(getpid()) + ".json"));
        file_.kind = "accuracy";
        file_.about = {{"dataset", "a \"quoted\" name.h5"}, {"command", "toile evaluate accuracy"}};
        Metric error;
        error.name = "accuracy/ridge/test/predicted/sqrt_mse";
        error.value = 7.43;
        error.low = 7.1;
        error.high = 7.8;
        error.unit = "mm";
        error.direction = MetricDirection::lower;
        error.tolerance = 0.1;
        error.samples = 64;
        error.distribution = MetricDistribution{7, 9, 9.5, 12};
        error.floor = 1.2;
        Metric seconds;
        seconds.name = "runtime/seconds";
        seconds.unit = "s";
        file_.metric = {error, seconds};
        document_ = metric_document(file_);
    }
    void TearDown() override { std::filesystem::remove(path_); }

    /// The complaint about a document as `where: what`.
    std::string complaint(const Json& document, const std::string& kind = "accuracy") {
        std::ofstream(path_) << document.dump();
        return complaint(kind);
    }
    std::string complaint(const std::string& kind = {}) {
        try {
            read_metric_file(path_, kind);
        } catch (const Error& error) {
            EXPECT_EQ(error.where().rfind(path_, 0), 0u) << error.where();
            return error.where().substr(path_.size()) + ": " + error.what();
        }
        return "none";
    }

    std::string path_;
    MetricFile file_;
    Json document_;
};

TEST_F(MetricFileTest, reads_what_it_wrote) {
    write_metric_file(path_, file_, Json{{"curves", {1, 2, 3}}});
    const MetricFile read = read_metric_file(path_, "accuracy");
    EXPECT_EQ(read.kind, "accuracy");
    EXPECT_FALSE(read.program_version.empty());
    ASSERT_EQ(read.about.size(), 2u);
    EXPECT_EQ(read.about[0].name, "dataset");
    EXPECT_EQ(read.about[0].value, "a \"quoted\" name.h5");
    ASSERT_EQ(read.metric.size(), 2u);
    const Metric& error = read.metric[0];
    EXPECT_EQ(error.name, file_.metric[0].name);
    EXPECT_EQ(error.value, 7.43);
    EXPECT_EQ(error.low, 7.1);
    EXPECT_EQ(error.high, 7.8);
    EXPECT_EQ(error.unit, "mm");
    EXPECT_EQ(error.direction, MetricDirection::lower);
    EXPECT_EQ(error.tolerance, 0.1);
    EXPECT_EQ(error.samples, 64);
    ASSERT_TRUE(error.distribution);
    EXPECT_EQ(error.distribution->p99, 9.5);
    EXPECT_EQ(error.floor, 1.2);
    EXPECT_EQ(read_metric_document(path_).at("curves"), Json({1, 2, 3}));
}

TEST_F(MetricFileTest, a_number_that_is_not_finite_is_null_and_comes_back) {
    file_.metric[1].value = INFINITY;
    write_metric_file(path_, file_);
    EXPECT_EQ(read_metric_document(path_).at("metric").at(1).at("value"), nullptr);
    const Metric read = read_metric_file(path_).metric[1];
    EXPECT_TRUE(std::isnan(read.value));
    EXPECT_TRUE(std::isnan(read.low));
    EXPECT_FALSE(read.distribution);
    EXPECT_FALSE(read.floor);
}

TEST_F(MetricFileTest, an_interval_that_is_not_there_is_the_value_itself) {
    file_.metric[1].value = 3.0;
    EXPECT_EQ(metric_document(file_).at("metric").at(1).at("interval"), Json({3.0, 3.0}));
}

TEST_F(MetricFileTest, file_names_that_are_no_utf8_are_written) {
    file_.about[0].value = "caf\xE9.h5";
    write_metric_file(path_, file_);
    EXPECT_EQ(read_metric_file(path_).about[0].value, "caf\xEF\xBF\xBD.h5");
}

TEST_F(MetricFileTest, refuses_to_write_a_name_twice) {
    file_.metric[1].name = file_.metric[0].name;
    EXPECT_THROW(write_metric_file(path_, file_), Error);
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(MetricFileTest, refuses_members_that_every_kind_has) {
    EXPECT_THROW(write_metric_file(path_, file_, Json{{"metric", 3}}), Error);
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(MetricFileTest, a_file_of_another_version_is_refused_with_a_mend) {
    document_["version"] = 2;
    std::ofstream(path_) << document_.dump();
    try {
        read_metric_file(path_);
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("version 2; this program reads version 1"));
        EXPECT_EQ(error.where(), path_ + ":version");
        EXPECT_FALSE(error.mend().empty());
    }
}

TEST_F(MetricFileTest, one_defect_at_a_time) {
    EXPECT_EQ(complaint(document_), "none");
    EXPECT_THAT(complaint(document_, "noise"), testing::HasSubstr(":kind: this must be \"noise\""));
    EXPECT_THAT(complaint(Json::array()), testing::HasSubstr("an object"));
    for (const char* key : {"format", "version", "kind", "program_version", "about", "metric"}) {
        Json broken = document_;
        broken.erase(key);
        EXPECT_EQ(complaint(broken), std::string(":") + key + ": this key is missing");
    }
    for (const char* key : {"metric", "value", "interval", "unit", "direction", "tolerance", "samples"}) {
        Json broken = document_;
        broken["metric"][1].erase(key);
        EXPECT_EQ(complaint(broken), std::string(":metric[1].") + key + ": this key is missing");
        broken["metric"][1][key] = Json::object();
        EXPECT_THAT(complaint(broken), testing::StartsWith(std::string(":metric[1].") + key + ": this must be"));
    }
    const std::pair<const char*, Json> values[] = {{"metric", ""},
                                                   {"metric", document_["metric"][0]["metric"]},
                                                   {"value", "7"},
                                                   {"interval", {1.0}},
                                                   {"interval", {2.0, 1.0}},
                                                   {"interval", {"a", 1.0}},
                                                   {"direction", "up"},
                                                   {"tolerance", -0.1},
                                                   {"tolerance", nullptr},
                                                   {"samples", -1},
                                                   {"samples", 1.5},
                                                   {"samples", 1e30},
                                                   {"floor", "high"},
                                                   {"distribution", 3},
                                                   {"distribution", {{"median", 1}}},
                                                   {"colour", "red"}};
    for (const auto& [key, value] : values) {
        Json broken = document_;
        broken["metric"][1][key] = value;
        EXPECT_NE(complaint(broken), "none") << key << ' ' << value;
    }
    Json broken = document_;
    broken["version"] = "1";
    EXPECT_EQ(complaint(broken), ":version: this must be a whole number");
    broken = document_;
    broken["about"]["dataset"] = 3;
    EXPECT_EQ(complaint(broken), ":about.dataset: this must be a text");
}

TEST_F(MetricFileTest, refuses_what_is_no_json_and_what_is_no_file) {
    EXPECT_EQ(complaint(), ": there is no such file");
    const std::string deep(100'000, '[');
    for (const std::string& text : std::vector<std::string>{"", "{", "\xff\xfe", deep, "{\"format\": nan}"}) {
        std::ofstream(path_) << text;
        EXPECT_THAT(complaint(), testing::HasSubstr("not valid JSON")) << text;
    }
    EXPECT_THROW(read_metric_file(std::filesystem::temp_directory_path()), Error);
}

}  // namespace
}  // namespace toile::files

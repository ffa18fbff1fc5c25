#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/baseline_section.h"
#include "tests/evaluate/evaluated_folder.h"

namespace toile::evaluate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class BaselineSection : public testing::Test {
  protected:
    void SetUp() override {
        before_.kind = "results";
        before_.about = {{"accuracy.config_hash", "12ab"}, {"accuracy.command", "one"}};
        before_.metric = {metric_of("same", 10, 0, "mm"), metric_of("worse", 10, 0, "mm"),
                          metric_of("gone", 10, 0, "mm"), metric_of("better", 10, 0, "mm"),
                          metric_of("told", 10, 0, "s", files::MetricDirection::none)};
        now_ = before_;
        now_.metric = {metric_of("same", 10.1, 0, "mm"), metric_of("worse", 11, 0, "mm"),
                       metric_of("better", 9, 0, "mm"), metric_of("told", 99, 0, "s"), metric_of("new", 1, 0, "mm")};
    }
    BaselineComparison compare() {
        files::write_metric_file(path(), before_);
        return compare_with_baseline(path(), now_);
    }
    std::string path() const { return folder_.file("before.json"); }

    EvaluatedFolder folder_;
    files::MetricFile before_, now_;
};

TEST_F(BaselineSection, the_table_has_regressions_first) {
    const BaselineComparison comparison = compare();
    EXPECT_TRUE(comparison.trips());
    const nlohmann::ordered_json table = as_json(baseline_section(comparison)).at("blocks").at(0);
    std::vector<std::string> rows;
    for (const auto& row : table.at("rows"))
        rows.push_back(row[0].get<std::string>() + " " + row[1].get<std::string>());
    EXPECT_THAT(rows, ElementsAre("worse regressed", "gone missing", "same within", "better improved", "new new"));
    EXPECT_EQ(table.at("rows")[1][5].at("value"), nullptr);
    EXPECT_EQ(table.at("rows")[1][6], nullptr);
}

TEST_F(BaselineSection, lines_and_verdict_tell_what_trips) {
    const BaselineComparison comparison = compare();
    EXPECT_THAT(comparison.lines(), ElementsAre("worse: 11 mm, baseline 10 mm, worse by 1, allowed 0.2",
                                                "gone: not measured, baseline 10 mm"));
    EXPECT_THAT(baseline_verdict(comparison), HasSubstr("1 metric regressed, 1 not measured; 1 improved, 1 within"));
    now_ = before_;
    EXPECT_FALSE(compare().trips());
    EXPECT_THAT(baseline_verdict(compare()), HasSubstr("no regression; 0 improved, 4 within"));
}

TEST_F(BaselineSection, a_baseline_that_judges_nothing_says_so) {
    before_.metric = {before_.metric.back()};
    EXPECT_FALSE(compare().trips());
    EXPECT_THAT(baseline_verdict(compare()), HasSubstr("it judges no metric"));
}

TEST_F(BaselineSection, other_data_and_other_programs_are_named) {
    now_.about[0].value = "34cd";
    now_.about[1].value = "another";
    EXPECT_THAT(compare().differences, ElementsAre("accuracy.config_hash: 34cd, was 12ab"));
    EXPECT_THAT(baseline_section(compare()).text, testing::Contains(HasSubstr("34cd, was 12ab")));
}

TEST_F(BaselineSection, a_baseline_must_be_a_results_file_of_this_version) {
    EXPECT_THROW(compare_with_baseline(path(), now_), Error) << "no file";
    before_.kind = "accuracy";
    EXPECT_THROW(compare(), Error) << "another kind";
}

}  // namespace
}  // namespace toile::evaluate

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/report_verdict.h"
#include "tests/evaluate/evaluated_folder.h"

namespace toile::evaluate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ReportVerdict : public testing::Test {
  protected:
    /// Line `index` of all evaluations.
    std::string line(size_t index) {
        folder_.write();
        const std::vector<files::MetricFile> evaluations{folder_.accuracy, folder_.runtime, folder_.stability};
        const auto lines =
            report_verdict(read_accuracy_document(folder_.file("accuracy.json")), evaluations, std::nullopt);
        EXPECT_EQ(lines.size(), 5u);
        return lines.at(index);
    }
    auto& methods() { return folder_.accuracy_own["accuracy"]["predictors"][0]["methods"]; }

    EvaluatedFolder folder_;
};

TEST_F(ReportVerdict, tells_the_error_before_and_after_each_prior) {
    EXPECT_EQ(line(0),
              "Error on test (ridge, SqrtMSE): 7.4 mm (95 %: 7.2 to 7.6) as predicted; 6.1 mm (95 %: 5.9 to 6.3) after "
              "the inextensibility prior, limit 0, better by 1.3 mm; 7.3 mm (95 %: 7.1 to 7.5) after the quasistatic "
              "prior, μ = 0.32, 0.1 mm less: smaller than the simulator's noise. The simulator's own "
              "noise is 0.2 mm.");
}

TEST_F(ReportVerdict, says_where_a_prior_or_the_noise_was_not_measured) {
    folder_.accuracy.metric.resize(2);
    folder_.accuracy.metric[0].floor.reset();
    EXPECT_THAT(line(0), AllOf(HasSubstr("the quasistatic prior was not judged"), HasSubstr("noise was not measured"),
                               HasSubstr("better by 1.3 mm")));
    folder_.accuracy.metric.resize(1);
    EXPECT_THAT(line(0), HasSubstr("the inextensibility prior was not judged"));
    folder_.accuracy.metric.clear();
    EXPECT_EQ(line(0), "Error: no predictor was judged.");
}

TEST_F(ReportVerdict, speaks_of_another_split_where_there_is_no_test) {
    for (files::Metric& metric : folder_.accuracy.metric) metric.name.replace(metric.name.find("test"), 4, "train");
    EXPECT_THAT(line(0), HasSubstr("Error on train (ridge"));
}

TEST_F(ReportVerdict, tells_the_mu_that_was_learned_or_the_best_that_was_tried) {
    EXPECT_EQ(line(1), "Best μ of the quasistatic prior: 0.32, learned on train, 7.3 mm (95 %: 7.1 to 7.5) on test.");
    methods()[2]["method"] = "quasistatic@mu=0.1";
    methods()[2]["setting"] = 0.1;
    folder_.accuracy.metric[2].name = "accuracy/ridge/test/quasistatic@mu=0.1/sqrt_mse";
    EXPECT_THAT(line(1), HasSubstr("none was learned; of those tried, 0.1 has the least error on test, 7.3 mm"));
    folder_.accuracy.metric.resize(2);
    EXPECT_THAT(line(1), HasSubstr("no value was tried"));
}

TEST_F(ReportVerdict, tells_the_time_of_the_fastest_at_the_usual_tolerance) {
    EXPECT_EQ(
        line(2),
        "Time: the inextensibility prior takes 12.5 ms a sample (inextensibility/interior@1e-06), the quasistatic "
        "prior takes 30 ms a sample (quasistatic/newton@1e-06), at 2974 vertices.");
    folder_.runtime.metric.resize(3);
    EXPECT_THAT(line(2), HasSubstr("the quasistatic prior was not timed"));
}

TEST_F(ReportVerdict, tells_what_broke) {
    EXPECT_EQ(line(3),
              "What broke: 2 samples of the data set not accepted, 1 projection that a prior did not solve to its "
              "accuracy; 3 of 100 cases of the stability suite failed (xpbd 3).");
    folder_.stability.metric[1].value = 100;
    EXPECT_THAT(line(3), HasSubstr("all 100 cases of the stability suite passed"));
    folder_.stability.metric.clear();
    EXPECT_THAT(line(3), HasSubstr("no case of the stability suite was run"));
}

TEST_F(ReportVerdict, each_line_says_where_its_evaluation_is_missing) {
    const auto lines = report_verdict(std::nullopt, {}, std::nullopt);
    ASSERT_EQ(lines.size(), 5u);
    EXPECT_THAT(lines[0], HasSubstr("not measured; `toile evaluate accuracy`"));
    EXPECT_THAT(lines[1], HasSubstr("not measured; `toile evaluate accuracy`"));
    EXPECT_THAT(lines[2], HasSubstr("not measured; `toile evaluate runtime`"));
    EXPECT_THAT(lines[3], AllOf(HasSubstr("accuracy not measured"), HasSubstr("`toile evaluate stability`")));
    EXPECT_THAT(lines[4], HasSubstr("none was given"));
}

}  // namespace
}  // namespace toile::evaluate

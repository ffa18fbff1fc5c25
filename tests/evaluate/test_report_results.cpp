#include <gtest/gtest.h>

#include <cmath>

#include "cloth/error.h"
#include "evaluate/report_results.h"
#include "tests/evaluate/evaluated_folder.h"

namespace toile::evaluate {
namespace {

TEST(ReportResults, metrics_of_all_kinds_come_together) {
    files::MetricFile accuracy, runtime;
    accuracy.kind = "accuracy";
    accuracy.program_version = "0.1.0";
    accuracy.about = {{"dataset", "a.h5"}};
    accuracy.metric = {metric_of("accuracy/a", 1, 0, "mm")};
    runtime.kind = "runtime";
    runtime.program_version = "0.2.0";
    runtime.about = {{"dataset", "b.h5"}, {"program_version", "0.2.0"}};
    runtime.metric = {metric_of("runtime/b", 2, 0, "s")};
    const files::MetricFile results = gathered_results({accuracy, runtime});
    EXPECT_EQ(results.kind, "results");
    ASSERT_EQ(results.metric.size(), 2u);
    EXPECT_EQ(results.metric[1].name, "runtime/b");
    std::string about;
    for (const auto& line : results.about) about += line.name + "=" + line.value + ";";
    EXPECT_EQ(
        about,
        "accuracy.program_version=0.1.0;accuracy.dataset=a.h5;runtime.program_version=0.2.0;runtime.dataset=b.h5;");
    EXPECT_NO_THROW(files::metric_document(results));
}

TEST(ReportResults, csv_holds_every_number) {
    files::MetricFile results;
    files::Metric metric = metric_of("a", 7.25, 0.25, "mm", files::MetricDirection::higher);
    metric.distribution = files::MetricDistribution{1, 2, 3, 4.5};
    metric.floor = 0.1;
    results.metric = {metric};
    EXPECT_EQ(results_csv(results),
              "metric,value,low,high,unit,direction,tolerance,samples,median,p95,p99,largest,floor\n"
              "a,7.25,7,7.5,mm,higher,0.02,50,1,2,3,4.5,0.1\n");
}

TEST(ReportResults, csv_quotes_texts_and_leaves_out_what_is_no_number) {
    files::MetricFile results;
    files::Metric metric;
    metric.name = "a,\"b\"\nc";
    metric.unit = "%";
    metric.distribution = files::MetricDistribution{1, INFINITY, 3, 4};
    results.metric = {metric};
    EXPECT_EQ(results_csv(results).substr(results_csv(results).find('\n') + 1),
              "\"a,\"\"b\"\"\nc\",,,,%,none,0.05,0,1,,3,4,\n");
}

TEST(ReportResults, csv_numbers_come_back_to_the_last_bit) {
    files::MetricFile results;
    const double value = 0.1 + 0.2;
    results.metric = {metric_of("a", value, 0, "mm")};
    const std::string csv = results_csv(results);
    EXPECT_EQ(std::stod(csv.substr(csv.find("\na,") + 3)), value);
}

}  // namespace
}  // namespace toile::evaluate

#include "tests/evaluate/evaluated_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include "evaluate/quantity.h"
#include "files/hdf5_file.h"
#include "files/mesh_group.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json comparison(const std::string& method, double difference, const std::string& judgement) {
    return {{"predictor", "ridge"},   {"split", "test"},          {"method", method},
            {"quantity", "sqrt_mse"}, {"difference", difference}, {"interval", {difference - 0.1, difference + 0.1}},
            {"judgement", judgement}};
}

Json method(const std::string& name, const std::string& title, Json setting) {
    return {{"method", name}, {"title", title}, {"setting", std::move(setting)}};
}

}  // namespace

files::Metric metric_of(const std::string& name, double value, double half, const std::string& unit,
                        files::MetricDirection direction) {
    files::Metric metric;
    metric.name = name;
    metric.value = value;
    metric.low = value - half;
    metric.high = value + half;
    metric.unit = unit;
    metric.direction = direction;
    metric.tolerance = 0.02;
    metric.samples = 50;
    return metric;
}

EvaluatedFolder::EvaluatedFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = (std::filesystem::temp_directory_path() /
             ("toile_report_" + std::string(test->name()) + "_" + std::to_string(getpid())))
                .string();
    std::filesystem::create_directories(path_);
    accuracy.kind = "accuracy";
    accuracy.about = {{"dataset", "shirt.h5"}, {"command", "toile evaluate accuracy"}, {"config_hash", "12ab"}};
    const std::string begin = "accuracy/ridge/test/";
    accuracy.metric = {metric_of(begin + "predicted/sqrt_mse", 7.4, 0.2, "mm"),
                       metric_of(begin + "inextensibility@limit=0/sqrt_mse", 6.1, 0.2, "mm"),
                       metric_of(begin + "quasistatic@mu=best/sqrt_mse", 7.3, 0.2, "mm")};
    for (files::Metric& metric : accuracy.metric) metric.floor = 0.2;
    accuracy_own = {
        {"accuracy",
         {{"vertices", 4},
          {"overstretched_limit", 0.05},
          {"noise_floor", nullptr},
          {"remarks", Json::array()},
          {"splits", {{{"name", "test"}, {"samples", 52}, {"accepted", 50}, {"judged", 50}}}},
          {"predictors",
           {{{"name", "ridge"},
             {"methods",
              {method("predicted", "as predicted", nullptr),
               method("inextensibility@limit=0", "after the inextensibility prior, limit 0", 0.0),
               method("quasistatic@mu=best", "after the quasistatic prior, μ = 0.32", 0.32)}}}}},
          {"failures", Json::array({{{"predictor", "ridge"}, {"method", "predicted"}, {"id", 3}, {"what", "NaN"}}})},
          {"comparisons",
           {comparison("inextensibility@limit=0", -1.3, "better"),
            comparison("quasistatic@mu=best", -0.1, "smaller than the simulator's noise")}}}}};
    runtime.kind = "runtime";
    runtime.about = {{"dataset", "shirt.h5"}, {"vertices", "2974"}, {"config_hash", "12ab"}};
    const auto seconds = files::MetricDirection::none;
    runtime.metric = {metric_of("runtime/priors/inextensibility/cone@1e-06/seconds", 0.25, 0.01, "s", seconds),
                      metric_of("runtime/priors/inextensibility/interior@1e-06/seconds", 0.0125, 0.001, "s", seconds),
                      metric_of("runtime/priors/inextensibility/interior@1e-02/seconds", 0.004, 0.001, "s", seconds),
                      metric_of("runtime/priors/quasistatic/newton@1e-06/seconds", 0.03, 0.001, "s", seconds),
                      metric_of("runtime/priors/quasistatic/newton@1e-06/time_ratio", 20, 0.5, "ratio")};
    stability.kind = "stability";
    stability.metric = {metric_of("stability/implicit/passed_share", 100, 0, "%", files::MetricDirection::higher),
                        metric_of("stability/xpbd/passed_share", 94, 0, "%", files::MetricDirection::higher)};
}

EvaluatedFolder::~EvaluatedFolder() {
    std::filesystem::remove_all(path_);
}

std::string EvaluatedFolder::text(const std::string& name) const {
    std::ifstream in(file(name));
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

void EvaluatedFolder::write() {
    files::write_metric_file(file("accuracy.json"), accuracy, accuracy_own);
    files::write_metric_file(file("runtime.json"), runtime, Json{{"study", Json::array()}});
    files::write_metric_file(file("stability.json"), stability, Json{{"cases", Json::array()}});
}

void EvaluatedFolder::write_arrays() {
    files::Hdf5File out = files::Hdf5File::create(file("accuracy.h5"));
    out.set_attribute("/", "format", "toile accuracy");
    out.set_attribute("/", "version", 1);
    ClothMesh mesh;
    mesh.triangle = (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished();
    mesh.rest_position = (Positions(4, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0).finished();
    files::write_mesh_group(out, mesh, 0);
    out.write("/body/triangle", std::vector<std::int32_t>{0, 1, 2}, {1, 3});
    out.write("/shown/id", std::vector<std::int64_t>{17, 4}, {2});
    out.write("/shown/split", std::vector<std::int8_t>{2, 0}, {2});
    out.write("/shown/body", std::vector<float>(2 * 3 * 3, 0.5f), {2, 3, 3});
    std::vector<float> position;
    for (int k = 0; k < 2 * 4 * 3; ++k) position.push_back(0.01f * static_cast<float>(k));
    for (const char* view : {"target", "predicted", "quasistatic"}) {
        const std::string group = "/shown/" + std::string(view);
        std::vector<float> place = position;
        // the quasistatic prior has failed on the second sample
        if (std::string(view) == "quasistatic") place.back() = std::numeric_limits<float>::quiet_NaN();
        out.write(group + "/position", place, {2, 4, 3});
        out.write(group + "/distance", std::vector<float>{0, 0, 0, 0.02f, 0.01f, 0.01f, 0.01f, 0.01f}, {2, 4});
        out.write(group + "/stretch", std::vector<float>(8, 1.1f), {2, 4});
        out.write(group + "/strain", std::vector<float>(8, 0.1f), {2, 4});
        out.set_attribute(group, "title", "the " + std::string(view));
    }
    std::vector<float> image(2 * 6 * 2 * 2, 0.0f);
    image[0] = 0.012f;
    out.write("/shown/image", image, {2, 6, 2, 2});
    out.write("/mu/vertex", std::vector<double>{0.01, 0.1, 1, 10}, {4});
    out.write("/figures/id", std::vector<std::int64_t>{17, 4}, {2});
    out.write("/figures/split", std::vector<std::int8_t>{2, 0}, {2});
    for (const char* method : {"predicted", "inextensibility@limit=0", "quasistatic@mu=best"})
        for (int quantity = 0; quantity < quantity_count; ++quantity)
            out.write("/figures/ridge/" + std::string(method) + "/" + quantity_kind(quantity).name,
                      std::vector<double>{1.5, 2.5}, {2});
    out.close();
}

}  // namespace toile::evaluate

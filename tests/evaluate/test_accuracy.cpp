#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth/error.h"
#include "evaluate/accuracy.h"
#include "evaluate/accuracy_results.h"
#include "evaluate/accuracy_section.h"
#include "evaluate/accuracy_shown.h"
#include "files/hdf5_file.h"
#include "files/predictions_file.h"
#include "tests/evaluate/judged_dataset.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string bytes_of(const std::string& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

class Accuracy : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_accuracy_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        write_bodiless_dataset(path("dataset.h5"), samples);
        TestPredictions().write(path("shaken.h5"), path("dataset.h5"));
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// Two methods of each prior, nothing learned: quick.
    AccuracyOptions options() const {
        AccuracyOptions options;
        options.dataset = path("dataset.h5");
        options.predictions = {path("shaken.h5")};
        options.folder = path("out");
        options.limits = {0.0, 0.05};
        options.mus = {0.1, 10.0};
        options.learn_mu = LearnMu::none;
        return options;
    }

    static constexpr int samples = 24;
    fs::path folder_;
};

const files::Metric& find(const AccuracySummary& summary, const std::string& name) {
    for (const files::Metric& one : summary.verdicts.metric)
        if (one.name == name) return one;
    throw std::runtime_error("no metric " + name);
}

TEST_F(Accuracy, IsThatOfThePaper) {
    const AccuracySummary summary = evaluate_accuracy(options());
    const files::DatasetReader dataset(path("dataset.h5"));
    const files::PredictionsReader predictions(path("shaken.h5"));
    double squares = 0, largest = 0;
    int count = 0;
    for (int slot = 0; slot < samples; ++slot) {
        const files::SampleRecord sample = dataset.read(slot);
        if (sample.split != 0) continue;
        const Eigen::VectorXd distance = (predictions.read(sample.id) - sample.cloth).rowwise().norm();
        squares += distance.squaredNorm() / static_cast<double>(distance.size());
        largest += distance.maxCoeff();
        ++count;
    }
    EXPECT_NEAR(find(summary, "accuracy/shaken/train/predicted/sqrt_mse").value, 1e3 * std::sqrt(squares / count),
                1e-9);
    EXPECT_NEAR(find(summary, "accuracy/shaken/train/predicted/max_dist").value, 1e3 * largest / count, 1e-9);
    EXPECT_EQ(find(summary, "accuracy/shaken/train/inextensibility@limit=0/overstretched_share").value, 0.0);
    EXPECT_EQ(summary.figures.id.size(), static_cast<size_t>(samples));
    EXPECT_TRUE(summary.failure.empty());
}

TEST_F(Accuracy, DependsOnNoThreads) {
    AccuracyOptions two = options();
    two.folder = path("two");
    two.jobs = 3;
    evaluate_accuracy(options());
    evaluate_accuracy(two);
    for (const char* name : {"accuracy.json", "accuracy.h5"})
        EXPECT_EQ(bytes_of(path(std::string("out/") + name)), bytes_of(path(std::string("two/") + name))) << name;
}

TEST_F(Accuracy, StoresEverySamplesValues) {
    const AccuracySummary summary = evaluate_accuracy(options());
    const files::Hdf5File file = files::Hdf5File::open(summary.figures_file);
    const auto id = file.read<std::int64_t>("/figures/id", {samples}).value;
    const auto split = file.read<int>("/figures/split", {samples}).value;
    const auto value = file.read<double>("/figures/shaken/quasistatic@mu=10/sqrt_mse", {samples}).value;
    double squares = 0;
    int count = 0;
    for (size_t k = 0; k < value.size(); ++k) {
        if (split[k] != 2) continue;
        squares += value[k] * value[k];
        ++count;
    }
    EXPECT_NEAR(std::sqrt(squares / count), find(summary, "accuracy/shaken/test/quasistatic@mu=10/sqrt_mse").value,
                1e-12);
    EXPECT_EQ(file.string_attribute("/figures/shaken/quasistatic@mu=10/sqrt_mse", "unit"), "mm");
    EXPECT_THAT(id, Contains(50));
}

TEST_F(Accuracy, KeepsTheWorstToLookAt) {
    AccuracyOptions few = options();
    few.shown = 4;
    const AccuracySummary summary = evaluate_accuracy(few);
    const files::Hdf5File file = files::Hdf5File::open(summary.figures_file);
    EXPECT_THAT(file.members("/shown"),
                ElementsAre("id", "inextensibility", "predicted", "quasistatic", "split", "target"));
    EXPECT_THAT(file.read<int>("/shown/split", {4}).value, ElementsAre(2, 2, 1, 0));
    const auto distance = file.read<double>("/shown/predicted/distance", {4, 30}).value;
    const auto target = file.read<double>("/shown/target/distance", {4, 30}).value;
    EXPECT_GT(distance[0], 0.0);
    EXPECT_EQ(target[0], 0.0);
    double squares = 0;
    for (size_t v = 0; v < 30; ++v) squares += distance[v] * distance[v];
    double worst = 0;
    for (size_t k = 0; k < summary.figures.id.size(); ++k)
        if (summary.figures.split[k] == 2)
            worst = std::max(worst, at(summary.figures.predictor[0].method[0].sample[k], Quantity::sqrt_mse));
    EXPECT_NEAR(1e3 * std::sqrt(squares / 30), worst, 1e-5);
}

TEST_F(Accuracy, JudgesTheSplitsAndAsManySamplesAsAsked) {
    AccuracyOptions some = options();
    some.splits = {0};
    some.samples = 5;
    const AccuracySummary summary = evaluate_accuracy(some);
    ASSERT_EQ(summary.split.size(), 1u);
    EXPECT_EQ(summary.split[0].slot.size(), 5u);
    EXPECT_EQ(summary.split[0].accepted, 16);
    EXPECT_THAT(summary.figures.split, ::testing::Each(0));
    EXPECT_THAT(summary.remark, Contains(HasSubstr("of the 16 accepted train samples 5 were drawn")));
}

TEST_F(Accuracy, LearnsMuOnTheTrainSplit) {
    AccuracyOptions learn = options();
    learn.learn_mu = LearnMu::global;
    const AccuracySummary summary = evaluate_accuracy(learn);
    ASSERT_EQ(summary.mu.size(), 1u);
    const double best = find(summary, "accuracy/shaken/train/quasistatic@mu=best/sqrt_mse").value;
    for (const char* mu : {"0.1", "10"})
        EXPECT_LE(best,
                  find(summary, std::string("accuracy/shaken/train/quasistatic@mu=") + mu + "/sqrt_mse").value + 1e-6);
    const auto json = nlohmann::json::parse(bytes_of(summary.results));
    EXPECT_EQ(json.at("accuracy").at("predictors").at(0).at("mu").at("global").at("mu"), summary.mu[0].fit.global.mu);
}

TEST_F(Accuracy, LearnsNothingWhereTrainIsNotPredicted) {
    TestPredictions test_only;
    test_only.change = [](std::vector<std::int64_t>& id, std::vector<float>& predicted) {
        const size_t width = predicted.size() / id.size();  // slot 5 is of the test split
        id = {id[5], id[11], id[17], id[23]};
        std::vector<float> kept;
        for (const size_t slot : {5u, 11u, 17u, 23u})
            kept.insert(kept.end(), predicted.begin() + static_cast<std::ptrdiff_t>(slot * width),
                        predicted.begin() + static_cast<std::ptrdiff_t>((slot + 1) * width));
        predicted = kept;
    };
    test_only.write(path("test.h5"), path("dataset.h5"));
    AccuracyOptions some = options();
    some.predictions = {path("test.h5")};
    some.splits = {2};
    some.learn_mu.reset();
    const AccuracySummary summary = evaluate_accuracy(some);
    EXPECT_TRUE(summary.mu.empty());
    EXPECT_THAT(summary.remark, Contains(HasSubstr("was not learned for shaken")));
    some.learn_mu = LearnMu::vertex;
    EXPECT_THROW(evaluate_accuracy(some), Error) << "asked for, it must be possible";
}

TEST_F(Accuracy, ListsWhatHasNoValue) {
    TestPredictions far;
    far.change = [](std::vector<std::int64_t>&, std::vector<float>& predicted) {
        for (size_t k = 0; k < 90; ++k) predicted[k] *= 1e36f;  // finite, but not its products
    };
    far.write(path("far.h5"), path("dataset.h5"));
    AccuracyOptions wild = options();
    wild.predictions = {path("far.h5")};
    const AccuracySummary summary = evaluate_accuracy(wild);
    ASSERT_FALSE(summary.failure.empty());
    for (const AccuracyFailure& one : summary.failure) EXPECT_EQ(one.id, 50);
    const auto json = nlohmann::json::parse(bytes_of(summary.results));
    EXPECT_EQ(json.at("accuracy").at("failures").size(), summary.failure.size());
}

TEST_F(Accuracy, TellsAReport) {
    evaluate_accuracy(options());
    const auto section = accuracy_section(path("out"));
    ASSERT_TRUE(section);
    const auto json = as_json(*section);  // checks ids and columns
    EXPECT_EQ(json.at("id"), "accuracy");
    std::vector<std::string> types;
    for (const auto& block : json.at("blocks")) types.push_back(block.at("type"));
    for (const char* type : {"table", "curves", "histogram"}) EXPECT_THAT(types, Contains(type));
    EXPECT_THAT(json.at("blocks").at(0).dump(), HasSubstr("quasistatic@mu=10"));
}

TEST_F(Accuracy, TellsAReportNothingWithoutAnEvaluation) {
    EXPECT_FALSE(accuracy_section(path("nowhere")));
    fs::create_directories(path("out"));
    std::ofstream(path("out/accuracy.json")) << "{\"format\":\"toile metrics\",\"version\":99,\"kind\":\"accuracy\"}";
    EXPECT_THROW(accuracy_section(path("out")), Error);
    std::ofstream(path("out/accuracy.json"))
        << R"({"format":"toile metrics","version":1,"kind":"accuracy","program_version":"0","about":{},"metric":[]})";
    EXPECT_THROW(accuracy_section(path("out")), Error) << "its own members are missing";
}

TEST_F(Accuracy, RefusesOneDefectAtATime) {
    const auto refused = [&](auto change, const char* why) {
        AccuracyOptions wrong = options();
        wrong.folder = path("refused");
        change(wrong);
        EXPECT_THROW(evaluate_accuracy(wrong), Error) << why;
        EXPECT_FALSE(fs::exists(path("refused"))) << why;
    };
    refused([](AccuracyOptions& o) { o.jobs = 0; }, "jobs");
    refused([](AccuracyOptions& o) { o.samples = -1; }, "samples");
    refused([](AccuracyOptions& o) { o.limits = {-0.1}; }, "limit");
    refused([](AccuracyOptions& o) { o.mus = {0.0}; }, "mu");
    refused([](AccuracyOptions& o) { o.limits = {std::nan("")}; }, "limit");
    refused([](AccuracyOptions& o) { o.predictions = {o.predictions[0], o.predictions[0]}; }, "the same name twice");
    refused([](AccuracyOptions& o) { o.predictions = {"absent.h5"}; }, "no file");
    refused([](AccuracyOptions& o) { o.noise = o.dataset; }, "no noise file");
    TestPredictions target;
    target.name = "target";
    target.write(path("target.h5"), path("dataset.h5"));
    refused([&](AccuracyOptions& o) { o.predictions = {path("target.h5")}; }, "the truth's own name");
}

/// With a body, a failed sample and images.
class AccuracyOnABody : public Accuracy {
  protected:
    void write(int failed) const {
        generate::TinyDataset tiny;
        tiny.change_sample = [=](int slot, files::SampleRecord& sample) { sample.status = slot == failed ? 1 : 0; };
        tiny.write(path("dataset.h5"));
        TestPredictions().write(path("shaken.h5"), path("dataset.h5"));
    }
};

TEST_F(AccuracyOnABody, TellsOfPenetration) {
    write(-1);
    TestPredictions inside;
    inside.change = [](std::vector<std::int64_t>&, std::vector<float>& predicted) {
        for (size_t k = 2; k < predicted.size(); k += 3) predicted[k] *= 0.2f;  // towards the tube's axis
    };
    inside.write(path("shaken.h5"), path("dataset.h5"));
    const AccuracySummary summary = evaluate_accuracy(options());
    EXPECT_GT(find(summary, "accuracy/shaken/train/predicted/penetration").value, 1.0);
    EXPECT_LT(find(summary, "accuracy/target/train/target/penetration").value, 1.0);
    const files::Hdf5File file = files::Hdf5File::open(summary.figures_file);
    EXPECT_TRUE(file.has("/body/triangle"));
    EXPECT_EQ(file.shape("/shown/body")[0], 4);
    EXPECT_EQ(file.shape("/shown/image")[0], 4);
}

TEST_F(AccuracyOnABody, DoesNotJudgeWhatFailed) {
    write(0);
    const AccuracySummary summary = evaluate_accuracy(options());
    EXPECT_THAT(summary.figures.id, ElementsAre(11, 12, 13));
    EXPECT_THAT(summary.remark, Contains(HasSubstr("1 of the 2 train samples")));
}

TEST(WorstSamples, AreOfEachSplit) {
    const std::vector<int> split{0, 0, 0, 1, 1, 2, 2, 2, 2};
    const std::vector<double> error{1, 3, 2, 5, 6, 1, 4, 2, 3};
    EXPECT_THAT(worst_samples(split, error, 4), ElementsAre(6, 8, 4, 1));
    EXPECT_THAT(worst_samples(split, error, 100).size(), 9u);
    EXPECT_THAT(worst_samples({0, 0}, {1, 2}, 4), ElementsAre(1, 0)) << "others fill what a split lacks";
    EXPECT_TRUE(worst_samples(split, error, 0).empty());
}

}  // namespace
}  // namespace toile::evaluate

#include <map>

#include "evaluate/ridge_predictor.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

class Ridge : public PredictorTest {
  protected:
    static std::map<std::string, double> facts(const Predictor& predictor) {
        std::map<std::string, double> value;
        for (const FitFact& fact : predictor.facts()) value[fact.name] = fact.value;
        return value;
    }
    /// Largest error over the accepted samples [m].
    static double worst(const Predictor& predictor, const PredictorData& data) {
        double largest = 0;
        for (const int slot : data.accepted())
            largest = std::max(
                largest,
                (predictor.displacement(data.input(slot, false)) - data.displacement(slot)).cwiseAbs().maxCoeff());
        return largest;
    }
};

TEST_F(Ridge, RecoversALinearFieldToAMicrometre) {
    const files::DatasetReader reader(written({.samples = 200}));
    const PredictorData data(reader);
    const auto predictor = fit_ridge_predictor({.explained_variance = 1}, data);
    EXPECT_LT(worst(*predictor, data), 1e-6);  // validation and test too; displacements are some 0.1 m
    EXPECT_GT(worst(*fit_predictor({.predictor = "mean"}, data), data), 0.01);
    const auto found = facts(*predictor);
    EXPECT_EQ(found.at("train_samples"), 120);
    EXPECT_EQ(found.at("joints"), 1);
    EXPECT_EQ(found.at("features"), 9);
    EXPECT_EQ(found.at("components"), 9);
    EXPECT_NEAR(found.at("explained_variance"), 1, 1e-9);
    EXPECT_LT(found.at("cross_validated_error_mm"), 1e-3);
}

TEST_F(Ridge, FewerComponentsExplainLess) {
    const files::DatasetReader reader(written({.samples = 200}));
    const PredictorData data(reader);
    double last = 0;
    for (const int components : {1, 2, 4}) {
        const auto found = facts(*fit_ridge_predictor({.components = components}, data));
        EXPECT_EQ(found.at("components"), components);
        EXPECT_GT(found.at("explained_variance"), last);
        last = found.at("explained_variance");
    }
    EXPECT_LT(last, 1);
}

TEST_F(Ridge, AGivenStrengthIsTaken) {
    const files::DatasetReader reader(written({.samples = 100}));
    const PredictorData data(reader);
    const auto strong = fit_ridge_predictor({.ridge = 1e12}, data);
    EXPECT_EQ(facts(*strong).at("ridge"), 1e12);
    const Positions mean = fit_predictor({.predictor = "mean"}, data)->displacement({});
    EXPECT_LT((strong->displacement(data.input(4, false)) - mean).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT(worst(*fit_ridge_predictor({.explained_variance = 1, .ridge = 0.0}, data), data), 1e-6);
}

TEST_F(Ridge, OneSampleOrOnePoseGivesTheMean) {
    PredictorDataset still{.samples = 20};
    still.change = [](int, files::SampleRecord& sample) { sample.pose.setZero(); };
    for (const PredictorDataset& dataset : {PredictorDataset{.samples = 1}, still}) {
        const files::DatasetReader reader(written(dataset));
        const PredictorData data(reader);
        const PredictorInput input = data.input(0, false);
        const Positions mean = fit_predictor({.predictor = "mean"}, data)->displacement(input);
        const auto predictor = fit_ridge_predictor({}, data);
        EXPECT_LT((predictor->displacement(input) - mean).cwiseAbs().maxCoeff(), 1e-12);
        EXPECT_EQ(facts(*predictor).at("joints"), 0);
    }
}

TEST_F(Ridge, DoesNotDependOnTheThreads) {
    const files::DatasetReader reader(written({.samples = 400}));
    const PredictorData data(reader);
    const PredictorInput input = data.input(4, false);
    EXPECT_EQ(fit_ridge_predictor({.jobs = 1}, data)->displacement(input),
              fit_ridge_predictor({.jobs = 3}, data)->displacement(input));
}

}  // namespace
}  // namespace toile::evaluate

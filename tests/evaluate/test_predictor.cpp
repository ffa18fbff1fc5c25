#include <gmock/gmock.h>

#include <limits>

#include "cloth/error.h"
#include "evaluate/displacement_components.h"
#include "evaluate/predictor.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

class PredictorFactory : public PredictorTest {
  protected:
    std::string refusal(const PredictorOptions& options, const PredictorDataset& dataset = {.samples = 10}) const {
        try {
            const files::DatasetReader reader(written(dataset));
            const PredictorData data(reader);
            fit_predictor(options, data);
            return "";
        } catch (const Error& error) {
            EXPECT_FALSE(error.where().empty());
            return error.what();
        }
    }
};

TEST_F(PredictorFactory, MakesEachByItsName) {
    const files::DatasetReader reader(written({.samples = 10, .with_image = true}));
    const PredictorData data(reader);
    for (const std::string& name : predictor_names()) {
        const auto predictor = fit_predictor({.predictor = name}, data);
        EXPECT_EQ(predictor->name(), name);
        EXPECT_EQ(predictor->needs_image(), name == "image");
        EXPECT_FALSE(predictor->facts().empty());
        EXPECT_TRUE(predicted_cloth(*predictor, reader.read(3)).allFinite());
    }
}

TEST_F(PredictorFactory, RefusesOneOptionAtATime) {
    EXPECT_EQ(refusal({}), "");
    EXPECT_THAT(refusal({.predictor = "oracle"}), HasSubstr("one of ridge, mean, nearest, image"));
    EXPECT_THAT(refusal({.components = -1}), HasSubstr("components is -1"));
    EXPECT_THAT(refusal({.components = 10001}), HasSubstr("0 to 10000"));
    EXPECT_THAT(refusal({.explained_variance = 0}), HasSubstr("explained_variance"));
    EXPECT_THAT(refusal({.explained_variance = 1.01}), HasSubstr("explained_variance"));
    EXPECT_THAT(refusal({.ridge = -0.1}), HasSubstr("ridge"));
    EXPECT_THAT(refusal({.ridge = std::numeric_limits<double>::infinity()}), HasSubstr("ridge"));
    EXPECT_THAT(refusal({.jobs = 0}), HasSubstr("jobs"));
}

TEST_F(PredictorFactory, NeedsATrainSplit) {
    PredictorDataset dataset{.samples = 10, .with_image = true};
    dataset.change = [](int, files::SampleRecord& sample) { sample.split = std::max(1, sample.split); };
    for (const std::string& name : predictor_names()) {
        if (name == "image")
            EXPECT_EQ(refusal({.predictor = name}, dataset), "");  // it fits nothing
        else
            EXPECT_THAT(refusal({.predictor = name}, dataset), HasSubstr("no accepted sample in the train split"));
    }
}

TEST_F(PredictorFactory, TheMeanIsThatOfTheTrainSplit) {
    const files::DatasetReader reader(written({.samples = 10}));
    const PredictorData data(reader);
    const auto predictor = fit_predictor({.predictor = "mean"}, data);
    Positions sum = Positions::Zero(3, 3);
    for (const int slot : {0, 1, 2, 5, 6, 7}) sum += reader.read(slot).displacement;
    for (const int slot : {0, 4})
        EXPECT_LT((predictor->displacement(data.input(slot, false)) - sum / 6).cwiseAbs().maxCoeff(), 1e-16);
}

TEST_F(PredictorFactory, ManyAreOneAfterTheOther) {
    const files::DatasetReader reader(written({.samples = 20}));
    const PredictorData data(reader);
    const auto predictor = fit_predictor({}, data);
    std::vector<PredictorInput> input;
    for (const int slot : data.accepted()) input.push_back(data.input(slot, false));
    const std::vector<Positions> one = predictor->displacements(input, 1), three = predictor->displacements(input, 3);
    ASSERT_EQ(one.size(), input.size());
    for (size_t i = 0; i < input.size(); ++i) {
        EXPECT_EQ(one[i], three[i]);
        EXPECT_EQ(one[i], predictor->displacement(input[i]));
    }
}

}  // namespace
}  // namespace toile::evaluate

#include <gmock/gmock.h>

#include <fstream>

#include "cloth/error.h"
#include "evaluate/predict.h"
#include "files/predictions_file.h"
#include "generate/ordered_work.h"
#include "generate/validate.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

class Predict : public PredictorTest {
  protected:
    PredictSummary run(const std::string& dataset, const std::string& predictor, const std::string& out, int jobs = 1) {
        PredictOptions options;
        options.dataset = path(dataset);
        options.out = path(out);
        options.predictor.predictor = predictor;
        options.predictor.jobs = jobs;
        return predict(options);
    }
    std::string bytes(const std::string& name) const {
        std::ifstream file(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    /// Sets the samples of a split to something else: cloth and displacement.
    static PredictorDataset spoiled(int split) {
        PredictorDataset dataset;
        dataset.change = [split](int, files::SampleRecord& sample) {
            if (sample.split != split) return;
            sample.displacement *= 3;
            sample.cloth.setConstant(9);
        };
        return dataset;
    }
};

TEST_F(Predict, WritesAllAcceptedSamplesOfTheDataSet) {
    PredictorDataset dataset{.samples = 70};
    dataset.change = [](int slot, files::SampleRecord& sample) { sample.status = slot == 9 ? 1 : 0; };
    written(dataset);
    const PredictSummary summary = run("dataset.h5", "ridge", "out.h5");
    const files::PredictionsReader reader(path("out.h5"));
    const files::DatasetReader source(path("dataset.h5"));
    EXPECT_EQ(reader.predictor(), "ridge");
    EXPECT_EQ(reader.sample_count(), 69);
    EXPECT_FALSE(reader.has(1000 - 9));
    EXPECT_NO_THROW(files::check_predictions(reader, source, {0, 1, 2}));
    EXPECT_EQ(reader.header().dataset_config_hash, source.header().config_hash);
    EXPECT_THAT(reader.header().options, HasSubstr("predictor = \"ridge\""));
    EXPECT_THAT(reader.header().options, HasSubstr("train_samples = 42.0"));
    generate::ValidateOptions validate;
    validate.dataset = path("dataset.h5");
    EXPECT_TRUE(generate::validate_file(path("out.h5"), validate).defect.empty());
    EXPECT_EQ(summary.error[0].samples + summary.error[1].samples + summary.error[2].samples, 69);
}

TEST_F(Predict, ErrorsAreThoseOfTheFile) {
    written({.samples = 40});
    const PredictSummary summary = run("dataset.h5", "mean", "out.h5");
    const files::PredictionsReader predictions(path("out.h5"));
    const files::DatasetReader dataset(path("dataset.h5"));
    double squares = 0, largest = 0;
    int count = 0;
    for (int slot = 0; slot < 40; ++slot) {
        const files::SampleRecord sample = dataset.read(slot);
        if (sample.split != 2) continue;
        const Positions off = predictions.read(sample.id) - sample.cloth;
        squares += off.squaredNorm();
        largest += off.rowwise().norm().maxCoeff();
        ++count;
    }
    EXPECT_EQ(summary.error[2].samples, count);
    EXPECT_NEAR(summary.error[2].sqrt_mse, std::sqrt(squares / (3 * count)), 1e-12);
    EXPECT_NEAR(summary.error[2].max_dist, largest / count, 1e-12);
    EXPECT_THAT(predict_table(summary), HasSubstr("SqrtMSE [mm]"));
}

TEST_F(Predict, IsTheSameBytesEachTimeAndForAnyThreads) {
    written({.samples = 100, .with_image = true});
    for (const std::string& name : predictor_names()) {
        run("dataset.h5", name, name + "1.h5");
        run("dataset.h5", name, name + "2.h5");
        run("dataset.h5", name, name + "3.h5", 2);
        EXPECT_EQ(bytes(name + "1.h5"), bytes(name + "2.h5")) << name;
        EXPECT_EQ(bytes(name + "1.h5"), bytes(name + "3.h5")) << name;
    }
}

TEST_F(Predict, LooksAtTheClothOfTheTrainSplitAlone) {
    written({}, "sound.h5");
    written(spoiled(1), "validation.h5");
    written(spoiled(2), "test.h5");
    written(spoiled(0), "train.h5");
    for (const std::string name : {"ridge", "mean", "nearest"}) {
        run("sound.h5", name, "sound_out.h5");
        for (const std::string split : {"validation", "test"}) {
            run(split + ".h5", name, split + "_out.h5");
            // parameters are in an attribute, predictions in a dataset: all of it is the same
            EXPECT_EQ(bytes(split + "_out.h5"), bytes("sound_out.h5")) << name << " " << split;
        }
        run("train.h5", name, "train_out.h5");
        EXPECT_NE(bytes("train_out.h5"), bytes("sound_out.h5")) << name;
    }
}

TEST_F(Predict, PosesOutsideTheTrainSplitChangeNoOtherPrediction) {
    written({}, "sound.h5");
    PredictorDataset moved;
    moved.change = [](int slot, files::SampleRecord& sample) {
        if (slot == 4) sample.pose.setConstant(0.7);  // test; turns the joint that no other sample turns
    };
    written(moved, "moved.h5");
    for (const std::string name : {"ridge", "nearest"}) {
        run("sound.h5", name, "a.h5");
        run("moved.h5", name, "b.h5");
        const files::PredictionsReader a(path("a.h5")), b(path("b.h5"));
        EXPECT_EQ(a.header().options, b.header().options);
        for (const std::int64_t id : a.id()) {
            if (id == 996)
                EXPECT_NE(a.read(id), b.read(id));
            else
                EXPECT_EQ(a.read(id), b.read(id)) << name << " " << id;
        }
    }
}

TEST_F(Predict, LeavesNothingWhereItFails) {
    written({.samples = 20});
    EXPECT_THROW(run("dataset.h5", "image", "out.h5"), Error);
    EXPECT_THROW(run("dataset.h5", "ridge", "dataset.h5"), Error);
    EXPECT_THROW(run("none.h5", "ridge", "out.h5"), Error);
    EXPECT_THROW(run("dataset.h5", "ridge", "none/out.h5"), Error);
    PredictOptions options;
    options.dataset = path("dataset.h5");
    options.out = path("out.h5");
    const std::atomic<bool> interrupted = true;
    options.interrupted = &interrupted;
    EXPECT_THROW(predict(options), generate::Interrupted);
    EXPECT_FALSE(std::filesystem::exists(path("out.h5")));
    EXPECT_FALSE(std::filesystem::exists(path("out.h5.partial")));
}

}  // namespace
}  // namespace toile::evaluate

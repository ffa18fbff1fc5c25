#include "evaluate/nearest_predictor.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

using NearestPose = PredictorTest;

TEST_F(NearestPose, ReproducesTheTrainSplitExactly) {
    const files::DatasetReader reader(written({.samples = 100}));
    const PredictorData data(reader);
    const auto predictor = fit_nearest(data);
    ASSERT_EQ(data.train().size(), 60u);
    for (const int slot : data.train()) {
        EXPECT_EQ(predictor->displacement(data.input(slot, false)), data.displacement(slot));
        const files::SampleRecord sample = reader.read(slot);
        EXPECT_LT((predicted_cloth(*predictor, sample) - sample.cloth).cwiseAbs().maxCoeff(),
                  1e-5);  // float32 at 100 m
    }
}

TEST_F(NearestPose, TakesTheLeastSumOfSquaredAngles) {
    const files::DatasetReader reader(written({.samples = 100}));
    const PredictorData data(reader);
    const auto predictor = fit_nearest(data);
    for (const int slot : data.accepted()) {
        if (data.split(slot) == 0) continue;
        const auto rotation = [&](int one) {
            const Eigen::Vector3d theta = data.input(one, false).pose.row(1);
            return Eigen::Quaterniond(Eigen::AngleAxisd(theta.norm(), theta.normalized()));
        };
        double least = 1e9;
        int nearest = -1;
        for (const int one : data.train()) {
            const double angle = rotation(one).angularDistance(rotation(slot));
            if (angle < least) {
                least = angle;
                nearest = one;
            }
        }
        EXPECT_EQ(predictor->displacement(data.input(slot, false)), data.displacement(nearest)) << slot;
    }
}

TEST_F(NearestPose, OfEquallyNearOnesTheLowestId) {
    PredictorDataset dataset{.samples = 20};
    dataset.change = [](int slot, files::SampleRecord& sample) {
        sample.pose(1, 0) = slot % 2;  // two poses, many times each
        sample.pose(1, 1) = sample.pose(1, 2) = 0;
        sample.displacement.setConstant(slot);
    };
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    const auto predictor = fit_nearest(data);
    PredictorInput input = data.input(0, false);
    // ids fall with the slot: of the train split, slots 16 and 17 are the last of each pose
    EXPECT_EQ(predictor->displacement(input)(0, 0), 16);
    input.pose(1, 0) = 1;
    EXPECT_EQ(predictor->displacement(input)(0, 0), 17);
    input.pose(0, 0) = 2;  // a joint that the train split never turns
    EXPECT_EQ(predictor->displacement(input)(0, 0), 17);
}

}  // namespace
}  // namespace toile::evaluate

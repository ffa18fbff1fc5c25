#include "evaluate/displacement_components.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

class Components : public PredictorTest {
  protected:
    /// Displacements that are not linear in anything: 9 independent numbers each, of falling size.
    static void scramble(int slot, files::SampleRecord& sample) {
        std::mt19937_64 random(static_cast<std::uint64_t>(slot) + 100);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (int k = 0; k < 9; ++k) sample.displacement.data()[k] = std::pow(0.5, k) * uniform(random);
        sample.displacement = sample.displacement.cast<float>().cast<double>().eval();
    }
    static Eigen::MatrixXd train_rows(const PredictorData& data) {
        Eigen::MatrixXd rows(static_cast<Eigen::Index>(data.train().size()), 9);
        for (size_t i = 0; i < data.train().size(); ++i) {
            const Positions d = data.displacement(data.train()[i]);
            rows.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(d.data(), 9);
        }
        return rows;
    }
};

TEST_F(Components, AreThoseOfTheCovariance) {
    PredictorDataset dataset{.samples = 300};  // 180 train samples: two blocks of the Gram matrix
    dataset.change = scramble;
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    ComponentOptions options;
    options.components = 4;
    const DisplacementComponents found = displacement_components(data, options);
    const Eigen::MatrixXd rows = train_rows(data);
    const Eigen::RowVectorXd mean = rows.colwise().mean();
    EXPECT_LT((found.mean.transpose() - mean).cwiseAbs().maxCoeff(), 1e-15);
    const Eigen::MatrixXd centred = rows.rowwise() - mean;
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinV);
    ASSERT_EQ(found.direction.cols(), 4);
    EXPECT_EQ(found.drawn, 180);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(std::abs(found.direction.col(k).dot(svd.matrixV().col(k))), 1, 1e-9) << k;
    const Eigen::MatrixXd unit = found.direction.transpose() * found.direction;
    EXPECT_LT((unit - Eigen::MatrixXd::Identity(4, 4)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(Components, AsManyAsHoldTheVariance) {
    PredictorDataset dataset;
    dataset.change = scramble;
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    const Eigen::MatrixXd rows = train_rows(data);
    const Eigen::MatrixXd centred = rows.rowwise() - rows.colwise().mean();
    for (const double wanted : {0.5, 0.9, 0.99, 1.0}) {
        ComponentOptions options;
        options.explained_variance = wanted;
        const Eigen::MatrixXd all = displacement_components(data, options).direction;
        const auto held = [&](Eigen::Index count) {
            return (centred * all.leftCols(count)).squaredNorm() / centred.squaredNorm();
        };
        EXPECT_GE(held(all.cols()), wanted - 1e-9);
        EXPECT_LT(held(all.cols() - 1), wanted);
        options.most = 2;
        EXPECT_EQ(displacement_components(data, options).direction.cols(), std::min<Eigen::Index>(2, all.cols()));
    }
    ComponentOptions options;
    options.components = 1000;
    EXPECT_EQ(displacement_components(data, options).direction.cols(), 9);  // there are no more
}

TEST_F(Components, DoNotDependOnTheThreads) {
    PredictorDataset dataset{.samples = 300};
    dataset.change = scramble;
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    ComponentOptions options;
    const DisplacementComponents one = displacement_components(data, options);
    options.jobs = 3;
    const DisplacementComponents three = displacement_components(data, options);
    EXPECT_EQ(one.direction, three.direction);
    EXPECT_EQ(one.mean, three.mean);
}

TEST_F(Components, OfManySamplesSomeAreDrawn) {
    PredictorDataset dataset{.samples = 2000};
    dataset.change = scramble;
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    ComponentOptions options;
    options.components = 3;
    const DisplacementComponents a = displacement_components(data, options);
    EXPECT_EQ(a.drawn, most_drawn);
    options.seed = 2;
    const DisplacementComponents b = displacement_components(data, options);
    EXPECT_NE(a.direction, b.direction);
    EXPECT_EQ(a.mean, b.mean);  // of all
    for (int k = 0; k < 3; ++k) EXPECT_GT(std::abs(a.direction.col(k).dot(b.direction.col(k))), 0.99) << k;
}

TEST_F(Components, OneSampleHasNone) {
    const files::DatasetReader reader(written({.samples = 1}));
    const PredictorData data(reader);
    const DisplacementComponents found = displacement_components(data, {});
    EXPECT_EQ(found.direction.cols(), 0);
    EXPECT_EQ(found.direction.rows(), 9);
}

}  // namespace
}  // namespace toile::evaluate

#include "evaluate/ridge_predictor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth/parallel.h"
#include "evaluate/displacement_components.h"
#include "evaluate/pose_features.h"
#include "evaluate/ridge_regression.h"

namespace toile::evaluate {
namespace {

constexpr int batch_samples = 128, block_samples = 32;

/// Pose features of the train split: which joints, and their mean.
struct Features {
    explicit Features(const PredictorData& data) {
        JointRange range;
        for (const int slot : data.train()) range.add(data.input(slot, false).pose);
        joint = range.varying();
        mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(9 * joint.size()));
        for (const int slot : data.train()) mean += rotation_features(data.input(slot, false).pose, joint);
        mean /= static_cast<double>(data.train().size());
    }
    Eigen::VectorXd of(const skin::Pose& pose) const { return rotation_features(pose, joint) - mean; }

    std::vector<int> joint;
    Eigen::VectorXd mean;
};

struct Scores {
    RidgeSums sums;
    double variation = 0;  ///< Σ |d − d̄|²
};

/// Projects the train split onto the components, some samples at a time.
Scores project(const PredictorData& data, const DisplacementComponents& basis, const Features& features, int jobs) {
    Scores scores{RidgeSums(features.mean.size(), basis.direction.cols())};
    const std::vector<int>& train = data.train();
    const Eigen::Index size = basis.mean.size();
    Eigen::MatrixXd centred(size, batch_samples), score(basis.direction.cols(), batch_samples);
    for (size_t first = 0; first < train.size(); first += batch_samples) {
        const int count = static_cast<int>(std::min<size_t>(batch_samples, train.size() - first));
        for (int i = 0; i < count; ++i) {
            const Positions one = data.displacement(train[first + static_cast<size_t>(i)]);
            centred.col(i) = Eigen::Map<const Eigen::VectorXd>(one.data(), size) - basis.mean;
            scores.variation += centred.col(i).squaredNorm();
        }
        parallel_for((count + block_samples - 1) / block_samples, jobs, [&](int, int block) {
            const int begin = block * block_samples, samples = std::min(block_samples, count - begin);
            score.middleCols(begin, samples).noalias() =
                basis.direction.transpose() * centred.middleCols(begin, samples);
        });
        for (int i = 0; i < count; ++i)
            scores.sums.add(features.of(data.input(train[first + static_cast<size_t>(i)], false).pose), score.col(i));
    }
    return scores;
}

ComponentOptions component_options(const PredictorOptions& options) {
    ComponentOptions result;
    result.components = options.components;
    result.explained_variance = options.explained_variance;
    result.seed = options.seed;
    result.jobs = options.jobs;
    return result;
}

class RidgePredictor final : public Predictor {
  public:
    RidgePredictor(const PredictorOptions& options, const PredictorData& data) : features_(data) {
        DisplacementComponents basis = displacement_components(data, component_options(options));
        const Scores scores = project(data, basis, features_, options.jobs);
        const RidgeFit fit = fit_ridge(scores.sums, options.ridge);
        weights_ = basis.direction * fit.weights;
        mean_ = std::move(basis.mean);
        tell(data, basis, scores, fit);
    }

    std::string name() const override { return "ridge"; }

    Positions displacement(const PredictorInput& input) const override {
        Positions result(mean_.size() / 3, 3);
        Eigen::Map<Eigen::VectorXd> all(result.data(), result.size());
        all = mean_;
        all.noalias() += weights_ * features_.of(input.pose);
        return result;
    }

    std::vector<FitFact> facts() const override { return facts_; }

  private:
    void tell(const PredictorData& data, const DisplacementComponents& basis, const Scores& scores,
              const RidgeFit& fit) {
        const double samples = static_cast<double>(data.train().size());
        const double held = scores.sums.target_squared;
        const double left = std::max(scores.variation - held, 0.0) / samples;
        const double foreseen = std::sqrt((fit.cross_error * fit.cross_error + left) / data.vertex_count());
        facts_ = {{"train_samples", samples},
                  {"joints", static_cast<double>(features_.joint.size())},
                  {"features", static_cast<double>(features_.mean.size())},
                  {"components", static_cast<double>(basis.direction.cols())},
                  {"components_from_samples", static_cast<double>(basis.drawn)},
                  {"explained_variance", scores.variation > 0 ? held / scores.variation : 1.0},
                  {"ridge", fit.ridge},
                  {"cross_validated_error_mm", 1e3 * foreseen}};
    }

    Features features_;
    Eigen::VectorXd mean_;     // [M]
    Eigen::MatrixXd weights_;  // [M x D] P W
    std::vector<FitFact> facts_;
};

}  // namespace

std::unique_ptr<Predictor> fit_ridge_predictor(const PredictorOptions& options, const PredictorData& data) {
    return std::make_unique<RidgePredictor>(options, data);
}

}  // namespace toile::evaluate

#include "evaluate/nearest_predictor.h"

#include <algorithm>
#include <limits>

#include "evaluate/pose_features.h"

namespace toile::evaluate {
namespace {

class NearestPredictor final : public Predictor {
  public:
    explicit NearestPredictor(const PredictorData& data) : data_(&data), slot_(data.train()) {
        std::sort(slot_.begin(), slot_.end(), [&](int a, int b) { return data.id(a) < data.id(b); });
        JointRange range;
        for (const int slot : slot_) range.add(data.input(slot, false).pose);
        joint_ = range.varying();
        for (const int slot : slot_) rotation_.push_back(joint_rotations(data.input(slot, false).pose, joint_));
    }

    std::string name() const override { return "nearest"; }

    Positions displacement(const PredictorInput& input) const override {
        const std::vector<Eigen::Quaterniond> rotation = joint_rotations(input.pose, joint_);
        double least = std::numeric_limits<double>::infinity();
        size_t nearest = 0;
        for (size_t i = 0; i < rotation_.size(); ++i) {
            const double distance = squared_pose_distance(rotation, rotation_[i], least);
            if (distance >= least) continue;
            least = distance;
            nearest = i;
        }
        return data_->displacement(slot_[nearest]);
    }

    std::vector<FitFact> facts() const override {
        return {{"train_samples", static_cast<double>(slot_.size())}, {"joints", static_cast<double>(joint_.size())}};
    }

  private:
    const PredictorData* data_;
    std::vector<int> slot_, joint_;  // slots by id
    std::vector<std::vector<Eigen::Quaterniond>> rotation_;
};

}  // namespace

std::unique_ptr<Predictor> fit_nearest(const PredictorData& data) {
    return std::make_unique<NearestPredictor>(data);
}

}  // namespace toile::evaluate

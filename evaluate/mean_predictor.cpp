#include "evaluate/mean_predictor.h"

#include <utility>

#include "evaluate/displacement_components.h"

namespace toile::evaluate {
namespace {

class MeanPredictor final : public Predictor {
  public:
    explicit MeanPredictor(const PredictorData& data)
        : mean_(mean_displacement(data)), samples_(static_cast<double>(data.train().size())) {}

    std::string name() const override { return "mean"; }
    Positions displacement(const PredictorInput&) const override { return mean_; }
    std::vector<FitFact> facts() const override { return {{"train_samples", samples_}}; }

  private:
    Positions mean_;
    double samples_;
};

}  // namespace

std::unique_ptr<Predictor> fit_mean(const PredictorData& data) {
    return std::make_unique<MeanPredictor>(data);
}

}  // namespace toile::evaluate

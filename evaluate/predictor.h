#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluate/predictor_data.h"

namespace toile::evaluate {

/// Which predictor, and how it is fitted.
struct PredictorOptions {
    std::string predictor = "ridge";    ///< one of `predictor_names`
    int components = 0;                 ///< of displacement, 1 to 10,000; ridge; 0: see `explained_variance`
    double explained_variance = 0.999;  ///< share of the train split's that the components hold, at most 128 of them
    std::optional<double> ridge =
        std::nullopt;        ///< strength, 0 or more, see ridge_regression.h; none: by cross-validation
    std::uint64_t seed = 1;  ///< draws the train samples that components are taken from where there are many
    int jobs = 1;            ///< threads; nothing depends on it

    /// Throws Error naming the option, its value and what it may be.
    void validate() const;
};

/// A number that a fit came to.
struct FitFact {
    std::string name;  ///< "components"
    double value = 0;
};

/// Cloth for a pose: the displacement d̂ `[V x 3]`, from which r̂ = r̃ + q·d̂·q⁻¹ with the data set's embedded position r̃
/// and frame q of that pose. Fitted on the accepted samples of the train split; what it returns depends on these and on
/// the input alone. Its calls may come from several threads. The PredictorData it was fitted on must outlive it.
///
///     const files::DatasetReader dataset("dataset.h5");
///     const PredictorData data(dataset);
///     const auto predictor = fit_predictor({.predictor = "ridge"}, data);
///     const Positions predicted = predicted_cloth(*predictor, dataset.read(slot));
class Predictor {
  public:
    virtual ~Predictor() = default;

    virtual std::string name() const = 0;
    virtual bool needs_image() const { return false; }
    /// d̂ of one sample [m].
    virtual Positions displacement(const PredictorInput& input) const = 0;
    /// d̂ of several. A predictor that works on batches, as a network does, overrides it.
    virtual std::vector<Positions> displacements(std::span<const PredictorInput> input, int jobs) const;
    /// What the fit came to, in the order in which it is told.
    virtual std::vector<FitFact> facts() const = 0;
};

/// "ridge", "mean", "nearest", "image": the first is the default.
const std::vector<std::string>& predictor_names();

/// Fits one. Throws Error for options that make no sense, and where the data set has no accepted sample in the train
/// split or, for "image", no images.
std::unique_ptr<Predictor> fit_predictor(const PredictorOptions& options, const PredictorData& data);

/// r̂ `[V x 3]` [m] of a sample as `DatasetReader::read` gives it. Its cloth and displacement are not looked at.
Positions predicted_cloth(const Predictor& predictor, const files::SampleRecord& sample);

}  // namespace toile::evaluate

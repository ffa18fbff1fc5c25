#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "evaluate/judged_samples.h"
#include "evaluate/prediction_source.h"
#include "evaluate/prior_methods.h"

namespace toile::evaluate {

/// One way to look at the shown samples.
struct ShownView {
    std::string key;    ///< "target", "predicted", "inextensibility", "quasistatic", "quasistatic_mu_vertex"
    std::string title;  ///< for who looks at it
    PriorMethod method;
};

/// Samples that are kept to look at.
struct ShownSample {
    std::int64_t id = 0;
    int split = 0;
    Positions body;            ///< `[Vb x 3]`; empty without a body
    std::vector<float> image;  ///< `[C x H x W]`; empty without one
    struct Cloth {
        Positions position;
        ClothFields fields;
    };
    std::vector<Cloth> cloth;  ///< one for each view
};

struct Shown {
    std::vector<ShownView> view;
    std::vector<ShownSample> sample;
};

/// Indices into the figures of the samples with the largest error of the first predictor as it is: half of them from
/// the test split, the rest from the others, in order of split and then error; what a split lacks another fills.
std::vector<int> worst_samples(const std::vector<int>& split, const std::vector<double>& error, int most);

/// The views for these methods of one predictor: the truth, the prediction, the first of each prior (of the quasistatic
/// prior the best global μ, else that nearest to 0.1), and μ per vertex.
std::vector<ShownView> shown_views(const std::vector<PriorMethod>& methods);

/// Reads the samples at `slot` again and makes their views.
Shown make_shown(const TrueSamples& samples, const ClothJudge& judge, const std::vector<int>& slot,
                 const PredictionSource& source, const std::vector<PriorMethod>& methods, PriorRunner& runner,
                 int jobs);

}  // namespace toile::evaluate

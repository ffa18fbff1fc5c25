#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/metric_file.h"

namespace toile::evaluate {

/// What accuracy.json tells of one predictor's way through the priors, as far as verdict and facts need it.
struct AccuracyStory {
    struct Method {
        std::string name;   ///< "inextensibility@limit=0"
        std::string title;  ///< "after the inextensibility prior, limit 0"
        double setting = files::Metric::missing;
        const files::Metric* error = nullptr;  ///< sqrt_mse on `split`; null where it was not measured
        std::string judgement;                 ///< of its error against the prediction's; empty where there is none
    };
    struct Split {
        std::string name;
        int samples = 0, judged = 0;  ///< that the data set has, and that were judged
    };
    std::string predictor, split;
    std::vector<Split> splits;
    int vertices = 0;             ///< 0 where it does not tell
    std::vector<Method> methods;  ///< the first is the prediction as it is
    int failures = 0;             ///< samples of any predictor and split that a prior did not solve to its accuracy
    int not_judged = 0;           ///< samples that the data set has and did not accept

    /// The method of this name, else the first whose name begins so and that has an error; null where there is none.
    const Method* find(const std::string& name, const std::string& beginning) const;
};

/// Of the first predictor, on test (else validation, else train), from accuracy.json and what was read of its metrics,
/// which outlives the story. Nothing where the accuracy is not among the evaluations; Error where its own members are
/// damaged.
std::optional<AccuracyStory> accuracy_story(const std::string& folder,
                                            const std::vector<files::MetricFile>& evaluations);

}  // namespace toile::evaluate

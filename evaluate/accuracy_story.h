#pragma once

#include <string>
#include <vector>

#include "evaluate/accuracy_document.h"

namespace toile::evaluate {

/// What accuracy.json tells of one predictor's way through the priors, as far as the verdict needs it.
struct AccuracyStory {
    struct Method {
        std::string name;   ///< "inextensibility@limit=0"
        std::string title;  ///< "after the inextensibility prior, limit 0"
        double setting = files::Metric::missing;
        const files::Metric* error = nullptr;  ///< sqrt_mse on `split`, of the document; null where it was not measured
        std::string judgement;                 ///< of its error against the prediction's; empty where there is none
    };
    std::string predictor, split;
    std::vector<Method> methods;  ///< the first is the prediction as it is
    int failures = 0;             ///< samples of any predictor and split that a prior did not solve to its accuracy
    int not_judged = 0;           ///< samples that the data set has and did not accept

    /// The method of this name, else the first whose name begins so, with an error that is a number; null where there
    /// is none.
    const Method* find(const std::string& name, const std::string& beginning) const;
};

/// Of the first predictor, on test (else validation, else train). The document outlives the story.
AccuracyStory accuracy_story(const AccuracyDocument& document);

}  // namespace toile::evaluate

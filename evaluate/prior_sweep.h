#pragma once

#include <memory>

#include "cloth/factorisation_unit.h"
#include "evaluate/prior_study.h"
#include "evaluate/studied_prior.h"

namespace toile::evaluate {

/// A method at a tolerance, and what it made of each sample in its last round.
struct SweptPrior {
    SolutionMethod method;
    double tolerance = 0;
    std::unique_ptr<StudiedPrior> prior;
    std::vector<StudiedPrior::Solved> solved;      ///< `[N]`
    std::vector<StudiedPrior::Gradient> gradient;  ///< `[N]` where it was asked for

    std::string label() const;  ///< "tolerance 1e-06"
    std::string name() const;   ///< "inextensibility/cone@1e-06"
};

/// References of one prior's samples; those that could not be certified are told in the study and counted.
struct SweptReferences {
    std::string prior;
    std::vector<Reference> reference;  ///< `[N]`
    std::vector<int> certified;        ///< samples
};

/// One for each prior, and a sentence on how they were certified.
std::vector<SweptReferences> make_references(const RuntimeSamples& samples, Study& study);
const SweptReferences& of_prior(const std::vector<SweptReferences>& all, const std::string& prior);

/// Every method at every tolerance.
std::vector<std::unique_ptr<SweptPrior>> make_swept_priors(const RuntimeSamples& samples, const PriorSweep& sweep);

/// One factorisation of the mesh's matrix; Error if it fails, as it must not be timed then.
std::function<void()> factorisation(const std::shared_ptr<FactorisationUnit>& unit);
std::shared_ptr<FactorisationUnit> unit_of(const RuntimeSamples& samples);

/// The sentence that tells what times and ratios are.
std::string timing_note(const RuntimeSamples& samples, const Timings& timings, const FactorisationUnit& unit);

}  // namespace toile::evaluate

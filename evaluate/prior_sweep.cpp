#include "evaluate/prior_sweep.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <set>

#include "cloth/error.h"

namespace toile::evaluate {

std::string SweptPrior::label() const {
    return fmt::format("tolerance {:.0e}", tolerance);
}

std::string SweptPrior::name() const {
    return fmt::format("{}@{:.0e}", method.name(), tolerance);
}

namespace {

std::string names(const std::set<std::string>& all) {
    std::string text;
    for (const std::string& one : all) text += (text.empty() ? "" : " and ") + one;
    return text.empty() ? "no method" : text;
}

}  // namespace

std::vector<SweptReferences> make_references(const RuntimeSamples& samples, Study& study) {
    std::vector<SweptReferences> all;
    const std::vector<SolutionMethod> methods = solution_methods();
    for (auto first = methods.begin(); first != methods.end();) {
        const auto last = std::find_if(first, methods.end(), [&](const auto& m) { return m.prior != first->prior; });
        SweptReferences& one = all.emplace_back();
        one.prior = first->prior;
        one.reference = certified_references({first, last}, samples.rest, samples.predicted);
        double worst = 0.0;
        std::set<std::string> by;
        for (int s = 0; s < samples.count(); ++s) {
            const Reference& reference = one.reference[s];
            if (reference.certified) {
                one.certified.push_back(s);
                by.insert(reference.method);
                worst = std::max(worst, reference.residual);
                continue;
            }
            ++study.refused;
            study.left_out.push_back(fmt::format(
                "sample {} has no certified {} solution: its residual, computed again, is {:.2g} where {:.0e} was "
                "asked; the sample is refused",
                samples.record[s].id, one.prior, reference.residual, reference_tolerance));
        }
        study.text.push_back(fmt::format(
            "Reference of {}: solved to {:.0e} and certified by computing the contract's residual again; {} of {} "
            "samples, largest residual {:.1e}, by {}.",
            one.prior, reference_tolerance, one.certified.size(), samples.count(), worst, names(by)));
        first = last;
    }
    return all;
}

const SweptReferences& of_prior(const std::vector<SweptReferences>& all, const std::string& prior) {
    for (const SweptReferences& one : all)
        if (one.prior == prior) return one;
    throw Error("there is no prior of the name " + prior);
}

std::vector<std::unique_ptr<SweptPrior>> make_swept_priors(const RuntimeSamples& samples, const PriorSweep& sweep) {
    std::vector<std::unique_ptr<SweptPrior>> swept;
    for (const SolutionMethod& method : solution_methods())
        for (const double tolerance : sweep.tolerance) {
            auto one = std::make_unique<SweptPrior>();
            one->method = method;
            one->tolerance = tolerance;
            one->prior = method.make(samples.rest, tolerance, 1);
            one->solved.resize(samples.count());
            one->gradient.resize(samples.count());
            swept.push_back(std::move(one));
        }
    return swept;
}

std::shared_ptr<FactorisationUnit> unit_of(const RuntimeSamples& samples) {
    return std::make_shared<FactorisationUnit>(samples.rest.edge, samples.header.mesh.rest_position);
}

std::function<void()> factorisation(const std::shared_ptr<FactorisationUnit>& unit) {
    return [unit] {
        if (!unit->factor()) throw Error("the unit's matrix could not be factored");
    };
}

std::string timing_note(const RuntimeSamples& samples, const Timings& timings, const FactorisationUnit& unit) {
    const Spread one = timings.unit();
    return fmt::format(
        "{} samples of {} vertices, predictions: {}. Seconds are processor time a sample, one at a time on one thread, "
        "without what is done once for a mesh: the median of the rounds, then median and quartiles over the samples. A "
        "ratio is in units of one CHOLMOD factorisation of this mesh's 3V x 3V matrix ({}), timed with every sample: "
        "{:.2f} ms (rounds {:.2f} to {:.2f}).",
        samples.count(), samples.vertex_count(), samples.predictions, unit.description(), 1e3 * one.middle,
        1e3 * one.low, 1e3 * one.high);
}

}  // namespace toile::evaluate

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "evaluate/prior_study.h"
#include "evaluate/prior_sweep.h"

namespace toile::evaluate {
namespace {

/// ∂E/∂r* of E = Σ_i |r*_i − r_T,i|².
std::vector<double> loss_gradient(const std::vector<double>& position, const std::vector<double>& target) {
    std::vector<double> gradient(position.size());
    for (size_t k = 0; k < gradient.size(); ++k) gradient[k] = 2.0 * (position[k] - target[k]);
    return gradient;
}

/// |a − b| / |b|; a where b vanishes.
double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
    double difference = 0.0, size = 0.0;
    for (size_t k = 0; k < a.size(); ++k) {
        difference += (a[k] - b[k]) * (a[k] - b[k]);
        size += b[k] * b[k];
    }
    return std::sqrt(size > 0.0 ? difference / size : difference);
}

/// Gradients of one prior at the references, by sample; empty where there is none to trust.
using ReferenceGradients = std::vector<std::vector<double>>;

ReferenceGradients reference_gradients(const RuntimeSamples& samples, const SweptReferences& references,
                                       const SolutionMethod& method, Study& study) {
    const std::unique_ptr<StudiedPrior> prior = method.make(samples.rest, reference_tolerance, 1);
    ReferenceGradients gradient(samples.count());
    int kinks = 0;
    for (const int s : references.certified) {
        const StudiedPrior::Solved& solved = references.reference[s].solved;
        StudiedPrior::Gradient one;
        prior->backward(samples.predicted[s], solved, loss_gradient(solved.position, samples.target[s]), one);
        const prior::DerivativeReport& report = one.report[0];
        if (report.weakly_active > 0) ++kinks;
        if (report.status == prior::Status::converged && report.positive_definite) {
            gradient[s] = std::move(one.predicted);
            continue;
        }
        ++study.refused;
        study.left_out.push_back(fmt::format("sample {} has no {} gradient to compare with: {}; the sample is refused",
                                             samples.record[s].id, references.prior,
                                             report.positive_definite
                                                 ? fmt::format("linear residual {:.1e}", report.linear_residual)
                                                 : "its reference is no strict minimum"));
    }
    study.text.push_back(fmt::format(
        "Reference gradients of {}: at the certified solution, their linear systems solved to 1e-11; {} samples stand "
        "at a kink (an edge at its limit without force), where the map has two one-sided derivatives.",
        references.prior, kinks));
    return gradient;
}

struct Outcome {
    std::vector<double> error;
    int elsewhere = 0, doubtful = 0;
};

Outcome outcome_of(const SweptPrior& swept, const RuntimeSamples& samples, const SweptReferences& references,
                   const ReferenceGradients& gradient, MinimumCheck& check) {
    Outcome outcome;
    for (const int s : references.certified) {
        if (gradient[s].empty()) continue;
        if (check.other_minimum(samples.predicted[s], swept.solved[s], references.reference[s])) {
            ++outcome.elsewhere;
            continue;
        }
        const prior::DerivativeReport& report = swept.gradient[s].report[0];
        if (report.status != prior::Status::converged || !report.positive_definite) ++outcome.doubtful;
        outcome.error.push_back(relative_distance(swept.gradient[s].predicted, gradient[s]));
    }
    return outcome;
}

void prepare_results(Study& study) {
    study.curves.push_back({"gradients-error",
                            "Error of the gradient",
                            "|g − g'| / |g'| with g' the gradient at the certified reference. Bars: quartiles over the "
                            "samples. Position-based projection has no gradient.",
                            {"seconds a sample, projection and backward pass", "s", true},
                            {"relative error", "", true},
                            {}});
    study.table.push_back({"gradients-table",
                           "Gradients: error against run time",
                           "Doubtful: the backward pass itself says that it was not accurate, or that the positions "
                           "are no minimum. Elsewhere: went to another minimum than the reference; not in the errors.",
                           {{"method", ""},
                            {"setting", ""},
                            {"time", "ms"},
                            {"factorisations", "ratio"},
                            {"relative error", ""},
                            {"doubtful", ""},
                            {"elsewhere", ""}},
                           {}});
}

void add_result(Study& study, const SweptPrior& swept, const Timings& timings, int task, const Outcome& outcome) {
    const Spread error = quartiles(outcome.error), seconds = timings.seconds(task);
    const int count = static_cast<int>(outcome.error.size());
    add_time_metrics(study, swept.name(), timings, task, count);
    add_metric(study, swept.name() + "/relative_error", error, "ratio", count, swept.tolerance == 1e-6 ? 1.0 : 0.0);
    std::vector<StudySeries>& series = study.curves[0].series;
    if (series.empty() || series.back().name != swept.method.name()) series.push_back({swept.method.name(), {}});
    series.back().point.push_back({swept.label(), seconds, error});
    study.table[0].row.push_back({swept.method.name(), swept.label(),
                                  Spread{1e3 * seconds.low, 1e3 * seconds.middle, 1e3 * seconds.high},
                                  timings.units(task), error, double(outcome.doubtful), double(outcome.elsewhere)});
}

}  // namespace

Study study_gradients(const RuntimeSamples& samples, const PriorSweep& sweep, const RepeatOptions& repeat,
                      const Clock& clock) {
    Study study;
    study.name = "gradients";
    study.title = "Gradients: error against run time";
    const std::vector<SweptReferences> references = make_references(samples, study);
    std::map<std::string, ReferenceGradients> gradient;
    for (const SolutionMethod& method : solution_methods())
        if (!gradient.count(method.prior))
            gradient[method.prior] = reference_gradients(samples, of_prior(references, method.prior), method, study);

    const auto swept = make_swept_priors(samples, sweep);
    std::vector<TimedTask> task;
    for (const auto& one : swept)
        task.push_back({one->name(), [&samples, prior = one.get()](int s) {
                            StudiedPrior::Solved& solved = prior->solved[s];
                            prior->prior->project(samples.predicted[s], solved);
                            prior->prior->backward(samples.predicted[s], solved,
                                                   loss_gradient(solved.position, samples.target[s]),
                                                   prior->gradient[s]);
                        }});
    const auto unit = unit_of(samples);
    const Timings timings = time_interleaved(task, samples.count(), factorisation(unit), repeat, clock);
    study.text.push_back(timing_note(samples, timings, *unit));

    prepare_results(study);
    std::map<std::string, std::unique_ptr<MinimumCheck>> check;
    for (size_t k = 0; k < swept.size(); ++k) {
        const SolutionMethod& method = swept[k]->method;
        auto& of_method = check[method.name()];
        if (!of_method) of_method = std::make_unique<MinimumCheck>(method, samples.rest);
        add_result(
            study, *swept[k], timings, static_cast<int>(k),
            outcome_of(*swept[k], samples, of_prior(references, method.prior), gradient[method.prior], *of_method));
    }
    return study;
}

}  // namespace toile::evaluate

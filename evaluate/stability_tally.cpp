#include "evaluate/stability_tally.h"

#include <algorithm>

namespace toile::evaluate {
namespace {

/// A NaN is worse than anything.
void take_worse(double& worst, double value) {
    if (!(value <= worst)) worst = value;
}

std::vector<StabilityTally> tally(const std::vector<StabilityOutcome>& outcomes, bool by_group) {
    std::vector<StabilityTally> tallies;
    for (const StabilityOutcome& one : outcomes) {
        const std::string group = by_group ? one.group : "";
        auto found = std::find_if(tallies.begin(), tallies.end(), [&](const StabilityTally& each) {
            return each.solver == one.solver && each.group == group;
        });
        if (found == tallies.end()) {
            found = tallies.insert(tallies.end(), StabilityTally{});
            found->solver = one.solver;
            found->group = group;
        }
        found->add(one);
    }
    return tallies;
}

files::Metric metric(const StabilityTally& of, const std::string& what, double value, const std::string& unit,
                     files::MetricDirection direction, double tolerance) {
    files::Metric one;
    one.name = "stability/" + of.solver + "/" + what;
    one.value = value;
    one.unit = unit;
    one.direction = direction;
    one.tolerance = tolerance;
    one.samples = of.cases;
    return one;
}

}  // namespace

void StabilityTally::add(const StabilityOutcome& one) {
    prior = one.prior.has_value();
    ++cases;
    passed += one.passed();
    finite += one.finite;
    rests += one.rests;
    falling += one.falling;
    false_claims += one.false_claim();
    const double time = one.certificate.seconds;
    seconds += time;
    slowest = std::max(slowest, time);
    if (!one.prior) return;
    if (one.prior->status == prior::Status::converged)
        take_worse(worst_residual, one.prior->residual / one.prior->tolerance);
    if (!one.prior->derivative_checked) return;
    ++derivatives;
    accurate_derivatives += one.prior->derivative_met();
    if (one.prior->derivative_claimed) take_worse(worst_identity, one.prior->identity_error);
}

std::vector<StabilityTally> tally_by_solver(const std::vector<StabilityOutcome>& outcomes) {
    return tally(outcomes, false);
}

std::vector<StabilityTally> tally_by_group(const std::vector<StabilityOutcome>& outcomes) {
    return tally(outcomes, true);
}

std::vector<files::Metric> stability_metrics(const std::vector<StabilityOutcome>& outcomes) {
    using enum files::MetricDirection;
    // A case on the brink may pass on one machine and not on the next; a false claim is one anywhere.
    constexpr double few_cases = 0.02;
    std::vector<files::Metric> metrics;
    for (const StabilityTally& of : tally_by_solver(outcomes)) {
        metrics.push_back(metric(of, "passed_share", 100.0 * of.passed / of.cases, "%", higher, few_cases));
        metrics.push_back(metric(of, "not_finite", of.cases - of.finite, "cases", lower, 0.0));
        if (of.prior) metrics.push_back(metric(of, "false_claims", of.false_claims, "cases", lower, 0.0));
        metrics.push_back(metric(of, "seconds", of.seconds, "s", none, 0.0));
    }
    return metrics;
}

}  // namespace toile::evaluate

#include "bench/stress_report.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

#include "cloth/error.h"

namespace toile::bench {
namespace {

struct Summary {
    int count = 0, met = 0, most_iterations = 0, derivatives = 0, derivatives_met = 0, indefinite = 0;
    double worst_residual = 0, slowest = 0, seconds = 0, worst_linear = 0, worst_identity = 0;

    void add(const StressOutcome& outcome) {
        ++count;
        met += outcome.met();
        most_iterations = std::max(most_iterations, outcome.iterations);
        // a NaN must be seen as the worst
        if (!(outcome.residual / outcome.tolerance <= worst_residual))
            worst_residual = outcome.residual / outcome.tolerance;
        slowest = std::max(slowest, outcome.seconds);
        seconds += outcome.seconds;
        if (!outcome.derivative_checked) return;
        ++derivatives;
        derivatives_met += outcome.derivative_met();
        indefinite += !outcome.positive_definite;
        worst_linear = std::max(worst_linear, outcome.linear_residual);
        if (!(outcome.identity_error <= worst_identity)) worst_identity = outcome.identity_error;
    }
};

void print_line(std::ostream& out, const std::string& label, const Summary& sum) {
    out << std::left << std::setw(34) << label << std::right << std::setw(8) << sum.count << std::setw(8) << sum.met
        << std::setw(13) << std::setprecision(3) << sum.worst_residual << std::setw(8) << sum.most_iterations
        << std::setw(10) << sum.seconds << std::setw(10) << sum.slowest << std::setw(8) << sum.derivatives
        << std::setw(8) << sum.derivatives_met << std::setw(11) << sum.worst_linear << std::setw(11)
        << sum.worst_identity << std::setw(8) << sum.indefinite << '\n';
}

bool fell_short(const StressOutcome& outcome) {
    return !outcome.met() || !outcome.derivative_met();
}

std::string verdict(const StressOutcome& outcome) {
    if (!outcome.failure.empty()) return "failed: " + outcome.failure;
    if (outcome.false_claim()) return "FALSE CLAIM of convergence";
    if (!outcome.met()) return "tolerance not reached";
    if (outcome.false_derivative()) return "FALSE CLAIM of the derivative";
    return "derivative not accurate";
}

}  // namespace

void print_stress(std::ostream& out, const std::vector<StressOutcome>& outcome) {
    std::map<std::pair<PriorKind, PredictionKind>, Summary> by_kind;
    std::map<PriorKind, Summary> by_prior;
    for (const StressOutcome& each : outcome) {
        by_kind[{each.prior, each.kind}].add(each);
        by_prior[each.prior].add(each);
    }
    out << std::left << std::setw(34) << "prior, prediction" << std::right << std::setw(8) << "samples" << std::setw(8)
        << "met" << std::setw(13) << "worst/tol" << std::setw(8) << "steps" << std::setw(10) << "seconds"
        << std::setw(10) << "slowest" << std::setw(8) << "deriv." << std::setw(8) << "good" << std::setw(11) << "linear"
        << std::setw(11) << "identity" << std::setw(8) << "indef." << '\n';
    for (const auto& [key, sum] : by_kind)
        print_line(out, std::string(name(key.first)) + ", " + std::string(name(key.second)), sum);
    for (const auto& [prior, sum] : by_prior) print_line(out, std::string(name(prior)) + ", all", sum);
    for (const StressOutcome& each : outcome)
        if (fell_short(each))
            out << "--only " << each.problem << ": " << verdict(each) << "; residual " << each.residual << ", steps "
                << each.iterations << ", linear " << each.linear_residual << ", identity " << each.identity_error
                << "; " << each.description << '\n';
}

void write_failures(const std::vector<StressOutcome>& outcome, const std::string& file) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const StressOutcome& each : outcome)
        if (fell_short(each))
            list.push_back({{"only", each.problem},
                            {"sample", each.sample},
                            {"verdict", verdict(each)},
                            {"residual", each.residual},
                            {"tolerance", each.tolerance},
                            {"iterations", each.iterations},
                            {"linear_residual", each.linear_residual},
                            {"identity_error", each.identity_error},
                            {"problem", each.description}});
    std::ofstream out(file);
    out << list.dump(2) << '\n';
    if (!out.flush()) throw Error("the failures cannot be written", file);
}

bool any_false_claim(const std::vector<StressOutcome>& outcome) {
    return std::any_of(outcome.begin(), outcome.end(),
                       [](const StressOutcome& each) { return each.false_claim() || each.false_derivative(); });
}

}  // namespace toile::bench

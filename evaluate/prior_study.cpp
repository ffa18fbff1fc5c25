#include "evaluate/prior_study.h"

#include <spdlog/fmt/fmt.h>

#include <map>

#include "evaluate/position_projection.h"
#include "evaluate/prior_sweep.h"

namespace toile::evaluate {
namespace {

/// A number of sweeps, and where they took each sample.
struct SweptProjection {
    int sweeps = 0;
    std::vector<Positions> position;  // [N]
};

/// What one timed thing came to over the samples with a reference.
struct Outcome {
    std::vector<double> rms, largest;  // [m] of those that count
    std::vector<double> overstretch;   // largest edge over its limit, minus one
    int missed = 0;                    // the method says it did not get to its tolerance
    int elsewhere = 0;                 // another minimum: not in the errors
};

std::span<const double> numbers(const Positions& position) {
    return {position.data(), static_cast<size_t>(position.size())};
}

Positions positions(const std::vector<double>& flat) {
    return Eigen::Map<const Positions>(flat.data(), static_cast<Eigen::Index>(flat.size() / 3), 3);
}

Outcome outcome_of(const SweptPrior& swept, const RuntimeSamples& samples, const SweptReferences& references,
                   MinimumCheck& check, const PositionProjection& limits) {
    Outcome outcome;
    for (const int s : references.certified) {
        const StudiedPrior::Solved& solved = swept.solved[s];
        const Reference& reference = references.reference[s];
        if (solved.report[0].status != prior::Status::converged) ++outcome.missed;
        if (check.other_minimum(samples.predicted[s], solved, reference)) {
            ++outcome.elsewhere;
            continue;
        }
        const ClothDistance distance = cloth_distance(solved.position, reference.solved.position);
        outcome.rms.push_back(distance.rms);
        outcome.largest.push_back(distance.largest);
        outcome.overstretch.push_back(limits.overstretch(positions(solved.position)));
    }
    return outcome;
}

Outcome outcome_of(const SweptProjection& swept, const SweptReferences& references, const PositionProjection& limits) {
    Outcome outcome;
    for (const int s : references.certified) {
        const ClothDistance distance =
            cloth_distance(numbers(swept.position[s]), references.reference[s].solved.position);
        outcome.rms.push_back(distance.rms);
        outcome.largest.push_back(distance.largest);
        outcome.overstretch.push_back(limits.overstretch(swept.position[s]));
    }
    return outcome;
}

Spread scaled(Spread spread, double factor) {
    return {factor * spread.low, factor * spread.middle, factor * spread.high};
}

/// Curves and table of the study, filled row by row.
class Results {
  public:
    explicit Results(Study& study, const Timings& timings) : study_(study), timings_(timings) {
        distance_ = {"priors-rms",
                     "Distance to the reference solution",
                     "Root mean square over the vertices. Bars: quartiles over the samples. The reference of "
                     "position-based projection is the inextensibility prior's.",
                     {"seconds a sample", "s", true},
                     {"distance to the reference", "mm", true},
                     {}};
        largest_ = {"priors-largest",
                    "Largest distance to the reference solution",
                    "",
                    distance_.x,
                    {"largest distance", "mm", true},
                    {}};
        stretch_ = {"priors-stretch",
                    "Stretch that is left",
                    "The largest of all edges, over its limit.",
                    distance_.x,
                    {"longest edge over its limit, minus one", "", true},
                    {}};
        table_ = {"priors-table",
                  "Priors: error against run time",
                  "Missed: samples that did not reach the tolerance asked for. Elsewhere: samples that went to another "
                  "minimum of the quasistatic energy than the reference; they are not in the errors.",
                  {{"method", ""},
                   {"setting", ""},
                   {"time", "ms"},
                   {"factorisations", "ratio"},
                   {"distance, rms", "mm"},
                   {"largest", "mm"},
                   {"overstretch", "%"},
                   {"missed", ""},
                   {"elsewhere", ""}},
                  {}};
    }

    void add(const std::string& series, const std::string& label, const std::string& name, int task,
             const Outcome& outcome, double error_tolerance) {
        const int count = static_cast<int>(outcome.rms.size());
        const Spread seconds = timings_.seconds(task), rms = scaled(quartiles(outcome.rms), 1e3);
        const Spread largest = scaled(quartiles(outcome.largest), 1e3), stretch = quartiles(outcome.overstretch);
        add_time_metrics(study_, name, timings_, task, count);
        add_metric(study_, name + "/rms", rms, "mm", count, error_tolerance);
        add_metric(study_, name + "/largest", largest, "mm", count);
        add_metric(study_, name + "/overstretch", scaled(stretch, 100.0), "%", count);
        point(distance_, series, label, seconds, rms);
        point(largest_, series, label, seconds, largest);
        point(stretch_, series, label, seconds, stretch);
        table_.row.push_back({series, label, scaled(seconds, 1e3), timings_.units(task), rms, largest,
                              scaled(stretch, 100.0), double(outcome.missed), double(outcome.elsewhere)});
    }

    void finish() {
        // The quasistatic prior has springs, no limits: what stretch it leaves is no error.
        std::erase_if(stretch_.series, [](const StudySeries& one) { return one.name.starts_with("quasistatic"); });
        study_.curves = {distance_, largest_, stretch_};
        study_.table.push_back(table_);
    }

  private:
    static void point(StudyCurves& curves, const std::string& series, const std::string& label, const Spread& x,
                      const Spread& y) {
        if (curves.series.empty() || curves.series.back().name != series) curves.series.push_back({series, {}});
        curves.series.back().point.push_back({label, x, y});
    }

    Study& study_;
    const Timings& timings_;
    StudyCurves distance_, largest_, stretch_;
    StudyTable table_;
};

constexpr const char* projection_series = "position-based sweeps";
/// At the tolerance that the priors have by default, a distance twice a baseline's is a regression.
double gate_of_error(double tolerance) {
    return tolerance == 1e-6 ? 1.0 : 0.0;
}

}  // namespace

Study study_priors(const RuntimeSamples& samples, const PriorSweep& sweep, const RepeatOptions& repeat,
                   const Clock& clock) {
    Study study;
    study.name = "priors";
    study.title = "Priors: error against run time";
    const std::vector<SweptReferences> references = make_references(samples, study);
    const auto swept = make_swept_priors(samples, sweep);
    const prior::InextensibilityModel model = prior::InextensibilityModel::from(samples.rest, 0.0);
    const PositionProjection projection(model.edge, model.edge_max_length, model.target_stiffness);
    std::vector<SweptProjection> sweeps;
    for (const int count : sweep.sweeps)
        sweeps.push_back({count, std::vector<Positions>(static_cast<size_t>(samples.count()))});

    std::vector<TimedTask> task;
    for (const auto& one : swept)
        task.push_back({one->name(), [&samples, prior = one.get()](int s) {
                            prior->prior->project(samples.predicted[s], prior->solved[s]);
                        }});
    for (SweptProjection& one : sweeps)
        task.push_back({"position_projection",
                        [&one, &projection](int s) { projection.sweep(one.position[s], one.sweeps); },
                        [&one, &samples](int s) { one.position[s] = positions(samples.predicted[s]); }});
    const auto unit = unit_of(samples);
    const Timings timings = time_interleaved(task, samples.count(), factorisation(unit), repeat, clock);
    study.text.push_back(timing_note(samples, timings, *unit));

    Results results(study, timings);
    std::map<std::string, std::unique_ptr<MinimumCheck>> check;
    int k = 0;
    for (const auto& one : swept) {
        auto& of_method = check[one->method.name()];
        if (!of_method) of_method = std::make_unique<MinimumCheck>(one->method, samples.rest);
        results.add(one->method.name(), one->label(), one->name(), k++,
                    outcome_of(*one, samples, of_prior(references, one->method.prior), *of_method, projection),
                    gate_of_error(one->tolerance));
    }
    for (const SweptProjection& one : sweeps)
        results.add(projection_series, fmt::format("{} sweep{}", one.sweeps, one.sweeps > 1 ? "s" : ""),
                    fmt::format("position_projection@sweeps={}", one.sweeps), k++,
                    outcome_of(one, of_prior(references, "inextensibility"), projection), 0.0);
    results.finish();
    return study;
}

}  // namespace toile::evaluate

#include "evaluate/batch_study.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "evaluate/prior_sweep.h"
#include "evaluate/studied_prior.h"

namespace toile::evaluate {
namespace {

constexpr double batch_tolerance = 1e-6;

/// `count` samples one after the other, from the first again after the last.
std::vector<double> cycled(const std::vector<std::vector<double>>& each, int count) {
    std::vector<double> all;
    for (int k = 0; k < count; ++k) {
        const std::vector<double>& one = each[static_cast<size_t>(k) % each.size()];
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

/// A batch that is projected by some threads.
struct Batch {
    std::string prior;
    int size = 0, threads = 0;
    std::shared_ptr<StudiedPrior> method;
    std::vector<double> predicted, target;
    std::vector<double> loss_gradient;
    StudiedPrior::Solved solved;
    StudiedPrior::Gradient gradient;

    void project() { method->project(predicted, solved); }
    void fill_loss_gradient() {
        loss_gradient.resize(solved.position.size());
        for (size_t k = 0; k < loss_gradient.size(); ++k) loss_gradient[k] = 2.0 * (solved.position[k] - target[k]);
    }
    void backward() { method->backward(predicted, solved, loss_gradient, gradient); }
    int converged() const {
        return static_cast<int>(std::count_if(solved.report.begin(), solved.report.end(), [](const auto& report) {
            return report.status == prior::Status::converged;
        }));
    }
};

std::vector<int> thread_counts(const BatchSweep& sweep) {
    if (!sweep.threads.empty()) return sweep.threads;
    std::vector<int> threads;
    const int most = 2 * std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    for (int count = 1; count <= most; count *= 2) threads.push_back(count);
    return threads;
}

std::vector<std::unique_ptr<Batch>> make_batches(const RuntimeSamples& samples, const BatchSweep& sweep) {
    std::vector<std::unique_ptr<Batch>> batches;
    std::string last;
    for (const SolutionMethod& method : solution_methods()) {
        if (method.prior == last) continue;  // its default method was the first
        last = method.prior;
        for (const int threads : thread_counts(sweep)) {
            const std::shared_ptr<StudiedPrior> shared = method.make(samples.rest, batch_tolerance, threads);
            for (const int size : sweep.batch) {
                auto one = std::make_unique<Batch>();
                one->prior = method.prior;
                one->size = size;
                one->threads = threads;
                one->method = shared;
                one->predicted = cycled(samples.predicted, size);
                one->target = cycled(samples.target, size);
                batches.push_back(std::move(one));
            }
        }
    }
    return batches;
}

StudyCurves curves_of(const std::string& id, const std::string& title) {
    return {id,
            title,
            "Bars: smallest and largest of the rounds. Tolerance 1e-6, the default method of each prior.",
            {"samples in a batch", "", true},
            {"seconds a sample", "s", true},
            {}};
}

/// All rounds of one batch as seconds a sample. A batch is one "sample" of the timing: quartiles over one value say
/// nothing, so the spread is over the rounds.
Spread seconds_a_sample(const Timings& timings, int task, int size) {
    Spread spread = timings.seconds_by_round(task);
    return {spread.low / size, spread.middle / size, spread.high / size};
}

void add_point(Study& study, int curve, const Batch& batch, const std::string& what, const Timings& timings, int task) {
    const Spread seconds = seconds_a_sample(timings, task, batch.size);
    Spread units = timings.units(task);
    units = {units.low / batch.size, units.middle / batch.size, units.high / batch.size};
    const std::string series = fmt::format("{}, {} thread{}", batch.prior, batch.threads, batch.threads > 1 ? "s" : "");
    std::vector<StudySeries>& all = study.curves[curve].series;
    if (all.empty() || all.back().name != series) all.push_back({series, {}});
    const double size = batch.size;
    all.back().point.push_back({fmt::format("batch of {}", batch.size), {size, size, size}, seconds});
    const std::string name = fmt::format("{}/{}@batch={},threads={}", batch.prior, what, batch.size, batch.threads);
    add_metric(study, name + "/seconds", seconds, "s", batch.size);
    // Gated on one thread alone: what two threads bring depends on what else the machine does.
    add_metric(study, name + "/time_ratio", units, "ratio", batch.size,
               batch.threads == 1 && units.middle >= 0.05 ? 0.3 : 0.0);
    study.table[0].row.push_back({batch.prior, what, size, double(batch.threads),
                                  Spread{1e3 * seconds.low, 1e3 * seconds.middle, 1e3 * seconds.high}, units});
}

/// Times the batches of one thread, or those of several, and adds their points.
void measure(Study& study, const RuntimeSamples& samples, const BatchSweep& sweep, bool one_thread,
             const RepeatOptions& repeat, const Clock& clock) {
    std::vector<std::unique_ptr<Batch>> batches = make_batches(samples, sweep);
    std::erase_if(batches, [one_thread](const auto& one) { return (one->threads == 1) != one_thread; });
    std::vector<TimedTask> task;
    for (const auto& one : batches) {
        task.push_back({one->prior, [batch = one.get()](int) { batch->project(); }});
        task.push_back({one->prior, [batch = one.get()](int) { batch->backward(); },
                        [batch = one.get()](int) { batch->fill_loss_gradient(); }});
    }
    const Timings timings = time_interleaved(task, 1, factorisation(unit_of(samples)), repeat, clock);
    for (size_t k = 0; k < batches.size(); ++k) {
        const Batch& batch = *batches[k];
        if (const int missed = batch.size - batch.converged(); missed > 0)
            study.left_out.push_back(fmt::format("{}, batch of {}: {} samples did not reach {:.0e}", batch.prior,
                                                 batch.size, missed, batch_tolerance));
        add_point(study, 0, batch, "projection", timings, static_cast<int>(2 * k));
        add_point(study, 1, batch, "backward", timings, static_cast<int>(2 * k + 1));
    }
}

}  // namespace

Study study_batches(const RuntimeSamples& samples, const BatchSweep& sweep, const RepeatOptions& repeat,
                    const Clock& clock, const Clock& wall) {
    Study study;
    study.name = "batch";
    study.title = "Batch size and threads";
    study.text.push_back(fmt::format(
        "{} samples of {} vertices in turn, as many as a batch holds, on a machine of {} cores. Seconds of one thread "
        "are processor time, those of several are wall time, in which everything else that the machine does shows: "
        "compare them on an idle one. A ratio is in units of one factorisation of this mesh's matrix by the same "
        "clock. A sample's result does not depend on its batch or the threads.",
        samples.count(), samples.vertex_count(), std::thread::hardware_concurrency()));
    study.curves = {curves_of("batch-forward", "Projection: seconds a sample by batch size"),
                    curves_of("batch-backward", "Backward pass: seconds a sample by batch size")};
    study.table.push_back({"batch-table",
                           "Batch size and threads",
                           "",
                           {{"prior", ""},
                            {"pass", ""},
                            {"batch", ""},
                            {"threads", ""},
                            {"time a sample", "ms"},
                            {"factorisations", "ratio"}},
                           {}});
    measure(study, samples, sweep, true, repeat, clock);
    measure(study, samples, sweep, false, repeat, wall);
    return study;
}

}  // namespace toile::evaluate

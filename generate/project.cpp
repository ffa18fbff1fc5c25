#include "generate/project.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "files/problem_file.h"
#include "files/projection_file.h"
#include "generate/ordered_work.h"
#include "generate/prior_work.h"

namespace toile::generate {
namespace {

using Clock = std::chrono::steady_clock;

/// Consecutive samples that are in memory together.
struct Batch {
    int64_t first = 0;
    std::vector<double> predicted, loss_gradient, loss;
};

/// Samples a batch: enough to feed all threads, few enough to stay within some hundred megabytes on large meshes.
int64_t batch_size(const prior::RestState& rest, int jobs) {
    const double sample = 8.0 * (3.0 * 6.0 * rest.vertex_count + 2.0 * static_cast<double>(rest.edge.rows()));
    const auto fitting = static_cast<int64_t>(256e6 / sample);
    return std::clamp<int64_t>(fitting, 8, 8 * std::max(8, jobs));
}

/// Never leaves a single sample for last: a prior solves one alone by another path, with other last digits.
int64_t next_count(int64_t left, int64_t size) {
    return left <= size + 1 ? left : size;
}

/// One run: what its steps share.
struct Run {
    const ProjectConfig& config;
    const ProjectOptions& options;
    const files::ProblemFile& problem;
    PriorWork& work;
    ProjectSummary& summary;

    size_t width() const { return 3 * static_cast<size_t>(problem.mesh().vertex_count()); }
    void fail(int64_t sample, std::string text) const { summary.failed.push_back({sample, std::move(text)}); }
    void doubt(int64_t sample, std::string text) const { summary.doubtful.push_back({sample, std::move(text)}); }
};

void count_forward(const Run& run, const Batch& batch) {
    const std::vector<prior::Report>& report = run.work.report();
    for (size_t i = 0; i < report.size(); ++i) {
        const prior::Report& one = report[i];
        const int64_t sample = batch.first + static_cast<int64_t>(i);
        ProjectSummary& s = run.summary;
        ++s.samples;
        s.converged += one.status == prior::Status::converged;
        s.forward += one.seconds;
        s.sweep += one.seconds_sweep;
        s.assembly += one.seconds_assembly;
        s.factor += one.seconds_factor;
        s.solve += one.seconds_solve;
        if (one.status == prior::Status::rejected_input) {
            run.fail(sample, "was rejected: its prediction is not finite");
            continue;
        }
        s.worst_residual = std::max(s.worst_residual, one.residual);
        s.most_iterations = std::max(s.most_iterations, one.iterations);
        if (one.status == prior::Status::accuracy_not_reached)
            run.fail(sample, fmt::format("did not reach the accuracy: residual {:.2e}, tolerance {:.0e}", one.residual,
                                         run.config.tolerance()));
    }
}

/// E = Σ_i |r*_i − r_T,i|² and its gradient; zero, with a loss that is not finite, where a sample has none.
void take_loss(const Run& run, Batch& batch) {
    const size_t width = run.width(), count = run.work.report().size();
    const std::vector<double>& position = run.work.position();
    batch.loss_gradient = run.problem.target(batch.first, static_cast<int64_t>(count));
    batch.loss.assign(count, 0.0);
    for (size_t i = 0; i < count; ++i) {
        double* const at = batch.loss_gradient.data() + i * width;
        for (size_t k = 0; k < width; ++k) {
            const double difference = position[i * width + k] - at[k];
            batch.loss[i] += difference * difference;
            at[k] = 2 * difference;
        }
        if (!std::isfinite(batch.loss[i])) {
            batch.loss[i] = std::numeric_limits<double>::quiet_NaN();
            std::fill_n(at, width, 0.0);
        }
    }
}

void count_backward(const Run& run, const Batch& batch) {
    const std::vector<prior::DerivativeReport>& report = run.work.derivative_report();
    for (size_t i = 0; i < report.size(); ++i) {
        const prior::DerivativeReport& one = report[i];
        const int64_t sample = batch.first + static_cast<int64_t>(i);
        run.summary.backward += one.seconds;
        if (run.work.report()[i].status == prior::Status::rejected_input) continue;
        if (std::isnan(batch.loss[i])) {
            run.fail(sample, "has no gradient: its target is not finite, or too far away");
            continue;
        }
        if (one.status != prior::Status::converged)
            run.doubt(sample, fmt::format("has a gradient with a linear residual of {:.2e}", one.linear_residual));
        if (!one.positive_definite) run.doubt(sample, "has a Hessian that is not positive definite");
        const bool one_sided = one.weakly_active > 0 || one.active_set_distance <= run.config.tolerance();
        run.summary.near_kink += run.config.prior == Prior::inextensibility && one_sided;
    }
}

void differentiate(const Run& run, Batch& batch) {
    take_loss(run, batch);
    run.work.differentiate(batch.predicted, batch.loss_gradient);
    for (size_t i = 0; i < batch.loss.size(); ++i)
        if (std::isnan(batch.loss[i])) run.work.void_gradient(i);
    count_backward(run, batch);
}

void write_batch(const Run& run, const Batch& batch, files::ProjectionWriter& writer) {
    files::ProjectionRows rows;
    rows.predicted = batch.predicted;
    for (const prior::Report& one : run.work.report()) {
        rows.status.push_back(static_cast<int8_t>(one.status));
        rows.iterations.push_back(one.iterations);
        rows.seconds.push_back(one.seconds);
        rows.residual.push_back(one.residual);
    }
    if (run.options.gradient) {
        rows.loss = batch.loss;
        for (const prior::DerivativeReport& one : run.work.derivative_report()) {
            rows.gradient_seconds.push_back(one.seconds);
            rows.gradient_residual.push_back(one.linear_residual);
        }
    }
    run.work.fill(rows, run.options.gradient);
    writer.write(rows);
}

files::ProjectionHeader header_of(const ProjectConfig& config, const files::ProblemFile& problem, const PriorWork& work,
                                  bool gradient) {
    files::ProjectionHeader header;
    header.mesh = problem.mesh();
    work.describe(header);
    header.gradient = gradient;
    header.tolerance = config.tolerance();
    header.config = config.text;
    header.config_hash = config.hash;
    header.program_version = TOILE_VERSION;
    return header;
}

void report_progress(const Run& run) {
    if (!run.options.progress) return;
    const auto whole = [](int64_t count) { return static_cast<int>(std::min<int64_t>(count, 1 << 30)); };
    run.options.progress({"projecting", whole(run.summary.samples), whole(run.problem.sample_count()),
                          whole(run.summary.samples - run.summary.converged)});
}

}  // namespace

ProjectSummary project(const ProjectConfig& config, const ProjectOptions& options) {
    const auto start = Clock::now();
    const files::ProblemFile problem(options.problem);
    std::error_code absent;
    if (std::filesystem::equivalent(options.problem, options.out, absent))
        throw Error("the projection would replace the problem it is made from", options.out, "choose another --out");
    if (options.gradient && !problem.has_target())
        throw Error("a gradient needs /samples/target, which the problem does not have",
                    options.problem + ":/samples/target", "add it, or leave out --gradient");
    const prior::RestState rest = prior::rest_state(problem.mesh(), options.problem);
    const std::unique_ptr<PriorWork> work = make_prior_work(config, rest, options.jobs);
    ProjectSummary summary;
    summary.vertices = rest.vertex_count;
    summary.edges = rest.edge.rows();
    summary.gradient = options.gradient;
    const Run run{config, options, problem, *work, summary};
    const int64_t count = problem.sample_count(), size = batch_size(rest, options.jobs);
    files::ProjectionWriter writer(options.out, header_of(config, problem, *work, options.gradient), count);
    report_progress(run);
    for (Batch batch; batch.first < count;) {
        if (options.interrupted && *options.interrupted) throw Interrupted("interrupted: no projection was written");
        const int64_t samples = next_count(count - batch.first, size);
        batch.predicted = problem.predicted(batch.first, samples);
        work->project(batch.predicted);
        count_forward(run, batch);
        if (options.gradient) differentiate(run, batch);
        write_batch(run, batch, writer);
        batch.first += samples;
        report_progress(run);
    }
    writer.finish();
    summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return summary;
}

}  // namespace toile::generate

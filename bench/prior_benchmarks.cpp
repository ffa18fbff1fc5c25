#include "bench/prior_benchmarks.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "bench/peak_memory.h"
#include "bench/timed_priors.h"
#include "cloth/factorisation_unit.h"

namespace toile::bench {
namespace {

/// Made when first asked for.
const SpeedScene& table_scene() {
    static const SpeedScene scene = speed_scene(table_around, table_along, table_batch);
    return scene;
}

benchmark::internal::Benchmark* add(const std::string& name, int repetitions,
                                    const std::function<void(benchmark::State&)>& function) {
    return benchmark::RegisterBenchmark(name.c_str(), function)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->MinTime(0.05)
        ->Repetitions(repetitions);
}

void refuse(benchmark::State& state, const std::string& defect) {
    state.SkipWithError(defect.c_str());
}

template <typename Traits>
void time_forward(benchmark::State& state, TimedPrior<Traits>& timed) {
    if (const std::string defect = timed.forward_defect(); !defect.empty()) return refuse(state, defect);
    for (auto _ : state) timed.project_batch();
    state.counters["samples"] = timed.samples();
    state.counters["iterations"] = timed.mean_iterations();
}

template <typename Traits>
void time_forward_alone(benchmark::State& state, TimedPrior<Traits>& timed) {
    if (const std::string defect = timed.forward_defect(); !defect.empty()) return refuse(state, defect);
    for (auto _ : state)
        for (int k = 0; k < timed.alone(); ++k) timed.project_alone(k);
    state.counters["samples"] = timed.alone();
    state.counters["iterations"] = timed.mean_iterations_alone();
}

template <typename Traits>
void time_warm(benchmark::State& state, TimedPrior<Traits>& timed) {
    timed.forget();
    timed.project_warm();
    if (const std::string defect = timed.warm_defect(); !defect.empty()) return refuse(state, defect);
    for (auto _ : state) {
        state.PauseTiming();
        timed.forget();
        state.ResumeTiming();
        timed.project_warm();
    }
    state.counters["samples"] = timed.samples();
    state.counters["iterations"] = timed.mean_iterations_warm();
}

template <typename Traits>
void time_backward(benchmark::State& state, TimedPrior<Traits>& timed) {
    if (const std::string defect = timed.forward_defect(); !defect.empty()) return refuse(state, defect);
    timed.backward_batch();
    if (const std::string defect = timed.backward_defect(); !defect.empty()) return refuse(state, defect);
    for (auto _ : state) timed.backward_batch();
    state.counters["samples"] = timed.samples();
    state.counters["iterations"] = 0;
}

template <typename Traits>
void time_backward_alone(benchmark::State& state, TimedPrior<Traits>& timed) {
    if (const std::string defect = timed.forward_defect(); !defect.empty()) return refuse(state, defect);
    for (int k = 0; k < timed.alone(); ++k) {
        timed.backward_alone(k);
        if (const std::string defect = timed.backward_defect(); !defect.empty()) return refuse(state, defect);
    }
    for (auto _ : state)
        for (int k = 0; k < timed.alone(); ++k) timed.backward_alone(k);
    state.counters["samples"] = timed.alone();
    state.counters["iterations"] = 0;
}

/// A prior that is built when the first of its benchmarks runs.
template <typename Traits>
struct Late {
    const SpeedScene& scene;
    int samples, alone;
    typename Traits::Options options;
    std::unique_ptr<TimedPrior<Traits>> timed;

    TimedPrior<Traits>& get() {
        if (!timed) timed = std::make_unique<TimedPrior<Traits>>(scene, samples, alone, options);
        return *timed;
    }
};

template <typename Traits>
void add_rows(const std::string& method, const std::string& tolerance, const typename Traits::Options& options,
              int samples, int repetitions) {
    const auto late =
        std::make_shared<Late<Traits>>(Late<Traits>{table_scene(), samples, std::min(samples, 8), options, nullptr});
    const std::string name = std::string(Traits::name) + "/" + method + "/" + tolerance + "/";
    add(name + "forward/batch", repetitions, [late](benchmark::State& state) { time_forward(state, late->get()); });
    add(name + "forward/alone", repetitions,
        [late](benchmark::State& state) { time_forward_alone(state, late->get()); });
    add(name + "forward/warm", repetitions, [late](benchmark::State& state) { time_warm(state, late->get()); });
    add(name + "backward/batch", repetitions, [late](benchmark::State& state) { time_backward(state, late->get()); });
    add(name + "backward/alone", repetitions,
        [late](benchmark::State& state) { time_backward_alone(state, late->get()); });
}

template <typename Traits>
void add_scaling() {
    // One size in memory at a time: the next one takes its place.
    const auto kept = std::make_shared<std::pair<SpeedScene, std::unique_ptr<Late<Traits>>>>();
    for (const TubeSize& size : scaling_sizes()) {
        const auto get = [kept, size]() -> TimedPrior<Traits>& {
            auto& [scene, late] = *kept;
            if (!late || late->scene.rest.vertex_count != size.vertices()) {
                late.reset();
                scene = speed_scene(size.around, size.along, scaling_batch);
                late.reset(new Late<Traits>{scene, scaling_batch, 0, {}, nullptr});
            }
            return late->get();
        };
        const std::string name = std::string("scaling/") + Traits::name, end = "/" + std::to_string(size.vertices());
        add(name + "/forward" + end, 2, [get](benchmark::State& state) { time_forward(state, get()); });
        add(name + "/backward" + end, 2, [get](benchmark::State& state) { time_backward(state, get()); });
    }
}

void add_unit(int repetitions) {
    const auto unit = std::make_shared<std::unique_ptr<FactorisationUnit>>();
    add("unit/cholmod_default", repetitions, [unit](benchmark::State& state) {
        if (!*unit)
            *unit = std::make_unique<FactorisationUnit>(table_scene().rest.edge, table_scene().mesh.rest_position);
        if (!(*unit)->factor() || !((*unit)->solve_error() < 1e-10)) return refuse(state, "the factorisation failed");
        for (auto _ : state) (*unit)->factor();
        state.counters["samples"] = 1;
        state.counters["iterations"] = 0;
        state.SetLabel((*unit)->description());
    });
}

prior::InextensibilityOptions inextensibility(prior::InextensibilityOptions::Method method, double tolerance) {
    prior::InextensibilityOptions options;
    options.method = method;
    options.tolerance = tolerance;
    return options;
}

template <typename Traits>
double peak_memory() {
    return peak_memory_of([] {
        const SpeedScene& all = table_scene();
        TimedPrior<Traits> timed(all, all.samples, 0, {});
        timed.backward_batch();
        return timed.forward_defect().empty() && timed.backward_defect().empty();
    });
}

}  // namespace

const std::vector<TubeSize>& scaling_sizes() {
    static const std::vector<TubeSize> sizes{{53, 56}, {77, 80}, {108, 115}, {152, 163}, {218, 229}};
    return sizes;
}

void register_prior_benchmarks(int repetitions) {
    using Method = prior::InextensibilityOptions::Method;
    add_unit(4 * repetitions);
    add_rows<TimedInextensibility>("interior_point", "1e-4", inextensibility(Method::interior_point, 1e-4), table_batch,
                                   repetitions);
    add_rows<TimedInextensibility>("interior_point", "1e-6", inextensibility(Method::interior_point, 1e-6), table_batch,
                                   repetitions);
    // one after the other whatever the batch: a few show the time of one
    add_rows<TimedInextensibility>("cone", "1e-6", inextensibility(Method::cone, 1e-6), 2, std::min(repetitions, 2));
    using Way = prior::QuasistaticOptions::Method;
    add_rows<TimedQuasistatic>("fast", "1e-6", {.method = Way::fast}, table_batch, repetitions);
    // as many steps as it wants: the row shows what they cost
    add_rows<TimedQuasistatic>("newton_cg", "1e-6", {.method = Way::newton_cg, .max_iterations = 10'000}, 4,
                               std::min(repetitions, 2));
    add_scaling<TimedInextensibility>();
    add_scaling<TimedQuasistatic>();
}

std::map<std::string, double> peak_memories() {
    return {{TimedInextensibility::name, peak_memory<TimedInextensibility>()},
            {TimedQuasistatic::name, peak_memory<TimedQuasistatic>()}};
}

}  // namespace toile::bench

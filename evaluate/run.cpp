#include "evaluate/run.h"

#include <algorithm>
#include <filesystem>

#include "evaluate/noise.h"
#include "evaluate/runtime.h"
#include "evaluate/stability_report.h"
#include "evaluate/strain.h"
#include "files/dataset_file.h"
#include "files/predictions_file.h"
#include "generate/look.h"

namespace toile::evaluate {

namespace fs = std::filesystem;

namespace {

/// One run: what its stages share.
struct Run {
    const generate::SceneConfig& config;
    const generate::GenerateOptions& options;
    RunSummary& summary;

    const std::string& dataset() const { return summary.generated.dataset; }
    std::string folder() const { return fs::path(dataset()).parent_path().string(); }
    std::string file(const std::string& name) const { return (fs::path(folder()) / name).string(); }
    /// What every stage is told.
    template <typename StageOptions>
    StageOptions stage() const {
        StageOptions of_stage;
        of_stage.progress = options.progress;
        of_stage.interrupted = options.interrupted;
        if constexpr (requires { of_stage.jobs; }) of_stage.jobs = options.jobs;
        if constexpr (requires { of_stage.folder; }) of_stage.folder = folder();
        if constexpr (requires { of_stage.dataset; }) of_stage.dataset = dataset();
        if constexpr (requires { of_stage.command; }) of_stage.command = options.command;
        return of_stage;
    }
};

/// The slots of the samples whose pose numbers the scene wants to see; pose numbers that are no samples are passed
/// over.
std::vector<int> look_slots(const std::string& dataset, const std::vector<int>& pose) {
    const std::vector<std::int64_t> id =
        files::Hdf5File::open(dataset).read<std::int64_t>("/samples/id", {files::any_size}).value;
    std::vector<int> slot;
    for (const int number : pose)
        for (size_t i = 0; i < id.size(); ++i)
            if (id[i] == number) slot.push_back(static_cast<int>(i));
    return slot;
}

void make_data(Run& run) {
    RunSummary& summary = run.summary;
    summary.generated = generate::generate(run.config, run.options);
    summary.flawless = summary.generated.failed.empty();
    summary.look = generate::write_look(run.dataset(), run.folder(), look_slots(run.dataset(), run.config.output.look));
    generate::ValidateOptions check;
    check.jobs = run.options.jobs;
    if (run.options.progress)
        check.step = [&](int done, int total) { run.options.progress({"checking", done, total, 0}); };
    summary.validation = generate::validate_dataset(run.dataset(), check);
}

void measure_noise_of(Run& run) {
    NoiseOptions options = run.stage<NoiseOptions>();
    options.source = run.dataset();
    options.share = run.config.evaluate.noise->share;
    const NoiseSummary noise = measure_noise(options);
    run.summary.flawless &= noise.configured == noise.samples;
}

/// Whether there is anything to fit predictors on.
bool can_predict(Run& run) {
    if (!files::accepted_ids(files::DatasetReader(run.dataset()), {0}).empty()) return true;
    run.summary.remark.push_back("no sample of the train split was accepted: nothing was predicted");
    run.summary.flawless = false;
    return false;
}

void predict_all(Run& run) {
    for (const std::string& name : run.config.predict.predictor) {
        if (name == "image" && !run.config.image) {
            run.summary.remark.push_back("the scene has no [image]: the predictor image was left out");
            continue;
        }
        PredictOptions options = run.stage<PredictOptions>();
        options.out = run.file("predictions_" + name + ".h5");
        options.predictor.predictor = name;
        options.predictor.components = run.config.predict.components.value_or(0);
        options.predictor.ridge = run.config.predict.ridge;
        options.predictor.seed = run.config.seed;
        options.predictor.jobs = run.options.jobs;
        predict(options);
        run.summary.predictions.push_back(options.out);
    }
}

LearnMu learn_mu_of(const std::string& word) {
    if (word == "none") return LearnMu::none;
    return word == "global" ? LearnMu::global : LearnMu::vertex;
}

void measure_accuracy(Run& run) {
    const generate::EvaluateConfig& config = run.config.evaluate;
    AccuracyOptions options = run.stage<AccuracyOptions>();
    options.predictions = run.summary.predictions;
    options.limits = config.limit;
    options.mus = config.mu;
    options.learn_mu = learn_mu_of(config.learn_mu);
    options.samples = config.samples;
    options.shown = config.shown;
    run.summary.accuracy = evaluate_accuracy(options);
    run.summary.flawless &= run.summary.accuracy->failure.empty();
}

void measure_runtime(Run& run) {
    RuntimeOptions options = run.stage<RuntimeOptions>();
    options.studies = run.config.evaluate.runtime->study;
    options.quick = run.config.evaluate.runtime->quick;
    if (!run.summary.predictions.empty()) options.predictions.file = run.summary.predictions.front();
    run.summary.flawless &= evaluate_runtime(options).refused() == 0;
}

void measure_stability(Run& run) {
    StabilityOptions options = run.stage<StabilityOptions>();
    options.quick = run.config.evaluate.stability->quick;
    run.summary.flawless &= evaluate_stability(options, run.folder()).passed();
}

void measure_strain(Run& run) {
    StrainOptions options = run.stage<StrainOptions>();
    options.neighbourhood = neighbourhood_rule(run.config.evaluate.strain->neighbourhood);
    options.stretches_only = true;
    evaluate_strain(options);
}

void evaluate_all(Run& run) {
    const generate::EvaluateConfig& config = run.config.evaluate;
    if (config.noise) measure_noise_of(run);
    if (can_predict(run)) {
        predict_all(run);
        if (!run.summary.predictions.empty()) measure_accuracy(run);
    }
    if (config.runtime) measure_runtime(run);
    if (config.stability) measure_stability(run);
    if (config.strain) measure_strain(run);
}

}  // namespace

RunSummary run(const generate::SceneConfig& config, const RunOptions& options) {
    RunSummary summary;
    Run run{config, options.generate, summary};
    make_data(run);
    if (!summary.validation.defect.empty()) return summary;
    evaluate_all(run);
    if (!fs::exists(run.file("accuracy.json"))) return summary;
    ReportOptions report;
    report.folder = run.folder();
    report.command = options.generate.command;
    report.page_template = options.page_template;
    summary.report = write_report(report);
    return summary;
}

}  // namespace toile::evaluate

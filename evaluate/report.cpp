#include "evaluate/report.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/accuracy_document.h"
#include "evaluate/accuracy_scene.h"
#include "evaluate/filled_page.h"
#include "evaluate/report_document.h"
#include "evaluate/report_facts.h"
#include "evaluate/report_results.h"
#include "evaluate/report_sections.h"
#include "evaluate/report_verdict.h"
#include "files/new_file.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

std::string in_folder(const std::string& folder, const std::string& name) {
    return (std::filesystem::path(folder) / name).string();
}

std::vector<files::MetricFile> read_evaluations(const std::string& folder) {
    if (!std::filesystem::is_directory(folder)) throw Error("there is no such folder", folder);
    std::vector<files::MetricFile> evaluations;
    for (const char* kind : {"accuracy", "runtime", "stability", "strain", "noise"}) {
        const std::string path = in_folder(folder, std::string(kind) + ".json");
        if (std::filesystem::exists(path)) evaluations.push_back(files::read_metric_file(path, kind));
    }
    if (evaluations.empty())
        throw Error("no evaluation has left results in this folder", folder,
                    "these do: toile evaluate accuracy|runtime|stability|strain|noise, with --out " + folder);
    return evaluations;
}

std::string now() {
    return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::now()));
}

std::string megabytes(size_t bytes) {
    return fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(bytes));
}

std::string title(const std::vector<files::MetricFile>& evaluations, const std::string& folder) {
    const std::string dataset = told_about(evaluations, "dataset");
    return "toile report: " + (dataset.empty() ? folder : dataset);
}

/// Where no section has taken the 3D view, it gets one of its own.
void place_viewer(std::vector<ReportSection>& sections, const SceneData& data) {
    for (const ReportSection& section : sections)
        for (const ReportBlock& block : section.blocks)
            if (std::holds_alternative<ReportViewer>(block)) return;
    ReportSection section{"samples", "Samples in 3D"};
    section.text.push_back(
        fmt::format("{} samples that the accuracy was measured on, those of the largest errors among them.",
                    data.scene.samples.size()));
    section.blocks.emplace_back(
        ReportViewer{"samples-viewer", "Body, truth, prediction and what the priors make of it"});
    sections.push_back(std::move(section));
}

/// The texts of the three files.
struct Contents {
    std::string page, results, table;
};

/// None of the files is replaced before all have been written.
void write_files(const ReportSummary& summary, const Contents& contents) {
    files::NewFile page(summary.page), results(summary.results), table(summary.table);
    page.write(contents.page.data(), contents.page.size());
    results.write(contents.results.data(), contents.results.size());
    table.write(contents.table.data(), contents.table.size());
    table.commit();
    results.commit();
    page.commit();
}

}  // namespace

ReportSummary write_report(const ReportOptions& options) {
    const std::vector<files::MetricFile> evaluations = read_evaluations(options.folder);
    const files::MetricFile results = gathered_results(evaluations);

    ReportSummary summary;
    summary.page = in_folder(options.folder, "report.html");
    summary.results = in_folder(options.folder, "results.json");
    summary.table = in_folder(options.folder, "results.csv");
    summary.metrics = results.metric.size();
    for (const files::MetricFile& one : evaluations) summary.evaluations.push_back(one.kind);
    if (!options.baseline.empty()) summary.baseline = compare_with_baseline(options.baseline, results);
    std::optional<AccuracyDocument> accuracy;
    if (evaluations.front().kind == "accuracy")
        accuracy = read_accuracy_document(in_folder(options.folder, "accuracy.json"));
    summary.verdict = report_verdict(accuracy, evaluations, summary.baseline);

    ReportDocument document{title(evaluations, options.folder), summary.verdict, report_facts(evaluations, accuracy),
                            report_sections(options.folder)};
    if (summary.baseline) document.sections.insert(document.sections.begin(), baseline_section(*summary.baseline));
    const std::optional<SceneData> scene = accuracy ? accuracy_scene(options.folder) : std::nullopt;
    if (scene) {
        place_viewer(document.sections, *scene);
        summary.shown = scene->scene.samples.size();
        summary.shown_bytes = scene->bytes();
        document.facts.push_back(
            {"samples in the 3D view", fmt::format("{} ({})", summary.shown, megabytes(summary.shown_bytes))});
    }
    document.facts.push_back({"report made", now()});
    if (!options.command.empty()) document.facts.push_back({"by", options.command});

    Json json = as_json(document);
    if (scene) json["scene"] = as_json(scene->scene);
    const Contents contents{
        filled_page(options.page_template, json, scene ? scene->store.blobs() : std::vector<ReportBlob>{}),
        files::metric_text(results), results_csv(results)};
    summary.page_bytes = contents.page.size();
    write_files(summary, contents);
    return summary;
}

}  // namespace toile::evaluate

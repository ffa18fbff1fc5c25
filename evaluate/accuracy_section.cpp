#include "evaluate/accuracy_section.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "evaluate/accuracy_curves.h"
#include "evaluate/accuracy_document.h"
#include "evaluate/accuracy_figures.h"
#include "evaluate/mu_picture.h"

namespace toile::evaluate {
namespace {

using Align = ReportColumn::Align;

std::string spread_note(const files::Metric& metric) {
    std::string note;
    if (metric.distribution)
        note =
            fmt::format("median {:.4g}, 95 % {:.4g}, 99 % {:.4g}, largest {:.4g} {}", metric.distribution->median,
                        metric.distribution->p95, metric.distribution->p99, metric.distribution->largest, metric.unit);
    if (metric.floor)
        note += fmt::format("{}the simulator's noise {:.3g} {}", note.empty() ? "" : "; ", *metric.floor, metric.unit);
    return note;
}

ReportCell cell_of(const files::Metric* metric, const AccuracyDocument::Verdict* verdict) {
    if (!metric || !std::isfinite(metric->value)) return {};
    std::string note = spread_note(*metric);
    if (verdict)
        note +=
            fmt::format("{}against the prediction {:+.3g} {} (95 % {:+.3g} to {:+.3g}): {}", note.empty() ? "" : "; ",
                        verdict->difference, metric->unit, verdict->low, verdict->high, verdict->judgement);
    return Measured{metric->value, metric->low, metric->high, std::move(note)};
}

ReportColumn column_of(Quantity quantity) {
    const QuantityKind& kind = quantity_kind(quantity);
    return {kind.title, kind.unit, Align::number, 4};
}

constexpr Quantity table_quantities[] = {Quantity::sqrt_mse,
                                         Quantity::max_dist,
                                         Quantity::stretching_energy_error,
                                         Quantity::compression_energy_error,
                                         Quantity::normal_error,
                                         Quantity::overstretched_share,
                                         Quantity::largest_stretch,
                                         Quantity::penetration};

std::vector<ReportCell> row_of(const AccuracyDocument& document, const std::string& predictor, const std::string& split,
                               const std::string& method, std::span<const Quantity> quantities) {
    std::vector<ReportCell> row{predictor, method};
    for (const Quantity quantity : quantities)
        row.push_back(cell_of(document.find(predictor, split, method, quantity),
                              document.verdict_on(predictor, split, method, quantity)));
    return row;
}

/// The simulator's own error, as a row of its own.
std::vector<ReportCell> floor_row(const AccuracyDocument& document, const std::string& split) {
    std::vector<ReportCell> row{"simulator", "its noise"};
    for (const Quantity quantity : table_quantities) {
        const auto& first = document.predictor.front();
        const files::Metric* metric = document.find(first.name, split, first.method.front().name, quantity);
        row.emplace_back();
        if (metric && metric->floor) row.back() = *metric->floor;
    }
    row.emplace_back("");
    return row;
}

ReportTable split_table(const AccuracyDocument& document, const AccuracyDocument::Split& split) {
    ReportTable table{
        "accuracy-" + split.name,
        "Errors on the " + split.name + " split",
        fmt::format("{} samples. Brackets: 95 % bootstrap intervals over samples; hold the pointer over a "
                    "number for its distribution. The last column compares SqrtMSE with that of the "
                    "prediction as it is, sample by sample.",
                    split.judged),
        {{"predictor", "", Align::text}, {"method", "", Align::text}}};
    for (const Quantity quantity : table_quantities) table.columns.push_back(column_of(quantity));
    table.columns.push_back({"SqrtMSE, compared", "", Align::text});
    table.rows.push_back(row_of(document, "target", split.name, "target", table_quantities));
    table.rows.back().emplace_back("");
    if (document.has_floor) table.rows.push_back(floor_row(document, split.name));
    for (const AccuracyDocument::Predictor& predictor : document.predictor)
        for (const AccuracyDocument::Method& method : predictor.method) {
            table.rows.push_back(row_of(document, predictor.name, split.name, method.name, table_quantities));
            const auto* verdict = document.verdict_on(predictor.name, split.name, method.name, Quantity::sqrt_mse);
            table.rows.back().emplace_back(verdict ? verdict->judgement : std::string());
        }
    return table;
}

ReportTable energy_table(const AccuracyDocument& document, const AccuracyDocument::Split& split) {
    constexpr Quantity quantities[] = {Quantity::stretching_energy, Quantity::compression_energy,
                                       Quantity::stretching_energy_error, Quantity::compression_energy_error};
    ReportTable table{
        "accuracy-energy-" + split.name,
        "Spring energies before and after the priors, " + split.name + " split",
        "Mean over samples of the energy of the quasistatic model's edge springs, over the edges that are "
        "longer and shorter than at rest; errors are differences to the target's own (paper, Figure 5).",
        {{"predictor", "", Align::text}, {"method", "", Align::text}}};
    for (const Quantity quantity : quantities) table.columns.push_back(column_of(quantity));
    table.rows.push_back(row_of(document, "target", split.name, "target", quantities));
    for (const AccuracyDocument::Predictor& predictor : document.predictor)
        for (const AccuracyDocument::Method& method : predictor.method)
            table.rows.push_back(row_of(document, predictor.name, split.name, method.name, quantities));
    return table;
}

/// The method with the smallest SqrtMSE of those whose name begins so; null without any.
const AccuracyDocument::Method* best_method(const AccuracyDocument& document,
                                            const AccuracyDocument::Predictor& predictor, const std::string& split,
                                            const std::string& beginning) {
    const AccuracyDocument::Method* best = nullptr;
    double smallest = 0;
    for (const AccuracyDocument::Method& method : predictor.method) {
        const files::Metric* metric = document.find(predictor.name, split, method.name, Quantity::sqrt_mse);
        if (!method.name.starts_with(beginning) || !metric || !std::isfinite(metric->value)) continue;
        if (!best || metric->value < smallest) {
            best = &method;
            smallest = metric->value;
        }
    }
    return best;
}

/// "ridge: 7.43 mm as predicted; 7.16 mm (better) after quasistatic@mu=0.1; ..."
std::string predictor_sentence(const AccuracyDocument& document, const AccuracyDocument::Predictor& predictor,
                               const std::string& split) {
    const files::Metric* first =
        document.find(predictor.name, split, predictor.method.front().name, Quantity::sqrt_mse);
    if (!first) return {};
    std::string text = fmt::format("{}, {} split: SqrtMSE {:.3g} mm as predicted", predictor.name, split, first->value);
    for (const char* prior : {"inextensibility@", "quasistatic@"}) {
        const AccuracyDocument::Method* method = best_method(document, predictor, split, prior);
        if (!method) continue;
        const files::Metric* metric = document.find(predictor.name, split, method->name, Quantity::sqrt_mse);
        text += fmt::format("; {:.3g} mm after {}", metric->value, method->name);
        if (const auto* verdict = document.verdict_on(predictor.name, split, method->name, Quantity::sqrt_mse))
            text += fmt::format(" ({}: {:+.2g} mm, 95 % {:+.2g} to {:+.2g})", verdict->judgement, verdict->difference,
                                verdict->low, verdict->high);
    }
    return text + ".";
}

/// How many of a split's comparisons came out how.
std::string verdicts_sentence(const AccuracyDocument& document, const std::string& split) {
    std::map<std::string, int> count;
    int total = 0;
    for (const auto& [key, verdict] : document.verdict) {
        if (std::get<1>(key) != split) continue;
        ++total;
        ++count[verdict.judgement];
    }
    std::string text = fmt::format("Of {} differences to the prediction on the {} split", total, split);
    std::string separator = ": ";
    for (const auto& [judgement, number] : count) {
        text += fmt::format("{}{} {}", separator, number, judgement);
        separator = ", ";
    }
    return text + ". The note of each number says which.";
}

std::vector<std::string> section_text(const AccuracyDocument& document, const std::string& shown_split) {
    std::vector<std::string> text{
        "How far predicted cloth is from the simulated truth, as it is and after each prior. SqrtMSE is the root of "
        "the "
        "mean squared distance over vertices and samples, MaxDist the mean over samples of the largest distance."};
    for (const AccuracyDocument::Predictor& predictor : document.predictor) {
        text.push_back(predictor_sentence(document, predictor, shown_split));
        if (!predictor.mu_sentence.empty()) text.push_back(predictor.name + ": " + predictor.mu_sentence);
    }
    for (const AccuracyDocument::Split& split : document.split) text.push_back(verdicts_sentence(document, split.name));
    if (document.failures > 0)
        text.push_back(
            fmt::format("{} projections did not reach their accuracy; they count with the best that was "
                        "found, and accuracy.json names them.",
                        document.failures));
    for (std::string one : document.remark) {
        one[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(one[0])));
        text.push_back(one + ".");
    }
    std::erase(text, "");
    return text;
}

}  // namespace

std::optional<ReportSection> accuracy_section(const std::string& folder) {
    namespace fs = std::filesystem;
    const fs::path path = fs::path(folder) / "accuracy.json";
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return std::nullopt;
    const AccuracyDocument document = read_accuracy_document(path.string());
    if (document.split.empty() || document.predictor.empty()) return std::nullopt;
    // What was not seen in training counts most.
    const AccuracyDocument::Split& shown = document.split.back();
    ReportSection section{"accuracy", "Accuracy", section_text(document, shown.name)};
    for (auto split = document.split.rbegin(); split != document.split.rend(); ++split)
        section.blocks.emplace_back(split_table(document, *split));
    for (ReportCurves& curves : accuracy_curves(document, shown.name)) section.blocks.emplace_back(std::move(curves));
    section.blocks.emplace_back(energy_table(document, shown));
    const fs::path arrays = fs::path(folder) / "accuracy.h5";
    if (fs::exists(arrays, ignored)) {
        for (ReportHistogram& one : accuracy_histograms(document, shown.name, arrays.string()))
            section.blocks.emplace_back(std::move(one));
        if (std::optional<ReportPicture> mu = learned_mu_block(arrays.string()))
            section.blocks.emplace_back(std::move(*mu));
    }
    return section;
}

}  // namespace toile::evaluate

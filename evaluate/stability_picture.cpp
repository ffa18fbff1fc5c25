#include "evaluate/stability_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "generate/drawing.h"

namespace toile::evaluate {
namespace {

using generate::Color;

constexpr int left = 380;  // of the first cell: room for the cases' names
constexpr int cell_width = 92, row_height = 16, margin = 10, group_gap = 8;

enum class Verdict { passed, rose, restless, broken, absent };
struct Meaning {
    const char* text;
    Color color;
};
constexpr std::array<Meaning, 5> meanings{{{"passed", {0.55, 0.80, 0.62}},
                                           {"rests, energy rose", {0.95, 0.90, 0.45}},
                                           {"not within the gate", {0.93, 0.62, 0.30}},
                                           {"not finite or refused", {0.80, 0.30, 0.25}},
                                           {"not available", {0.87, 0.87, 0.87}}}};

Verdict verdict(const StabilityOutcome& one) {
    if (one.passed()) return Verdict::passed;
    if (one.status.rfind("not available", 0) == 0) return Verdict::absent;
    if (!one.finite) return Verdict::broken;
    return one.rests ? Verdict::rose : Verdict::restless;
}

/// Cases in the order of their first outcome, each with the y of its row.
struct Row {
    std::string group, name;
    int y;
};
std::vector<Row> rows_of(const std::vector<StabilityOutcome>& outcomes) {
    std::vector<Row> row;
    int y = 2 * row_height + 2 * margin;
    for (const StabilityOutcome& one : outcomes) {
        if (std::any_of(row.begin(), row.end(), [&](const Row& r) { return r.name == one.name; })) continue;
        if (!row.empty() && row.back().group != one.group) y += group_gap;
        row.push_back({one.group, one.name, y});
        y += row_height;
    }
    return row;
}

void draw_legend(files::Picture& picture) {
    int x = margin;
    for (const Meaning& meaning : meanings) {
        generate::fill(picture, x, margin - 2, 12, 12, meaning.color);
        generate::write_text(picture, x + 16, margin, meaning.text);
        x += 16 + 7 * static_cast<int>(std::string(meaning.text).size()) + 12;
    }
}

}  // namespace

files::Picture stability_picture(const std::vector<StabilityOutcome>& outcomes,
                                 const std::vector<std::string>& solver) {
    const std::vector<Row> rows = rows_of(outcomes);
    const int columns = static_cast<int>(solver.size());
    files::Picture picture = generate::blank_picture(std::max(left + columns * cell_width + margin, 740),
                                                     (rows.empty() ? 0 : rows.back().y) + row_height + margin);
    draw_legend(picture);
    for (int k = 0; k < columns; ++k)
        generate::write_text(picture, left + k * cell_width + 4, row_height + margin + 4, solver[k]);
    for (const Row& row : rows) generate::write_text(picture, margin, row.y + 3, row.name);
    for (const StabilityOutcome& one : outcomes) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == one.name; });
        const int column = static_cast<int>(std::find(solver.begin(), solver.end(), one.solver) - solver.begin());
        const int x = left + column * cell_width;
        generate::fill(picture, x, row->y, cell_width - 2, row_height - 2,
                       meanings[static_cast<size_t>(verdict(one))].color);
        if (verdict(one) != Verdict::absent)
            generate::write_text(picture, x + 4, row->y + 3, fmt::format("{:.2f} s", one.certificate.seconds));
    }
    return picture;
}

}  // namespace toile::evaluate

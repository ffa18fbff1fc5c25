#include "evaluate/stability_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "generate/drawing.h"

namespace toile::evaluate {
namespace {

using generate::Color;

constexpr int left = 300;  // of the first cell: room for what is varied
constexpr int cell_width = 42, row_height = 16, margin = 10, gap = 8, letter = 6;
constexpr int top = margin + 5 * row_height;  // of the first row

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

/// "what, scene": a case's name.
std::size_t comma(const std::string& name) {
    return std::min(name.rfind(", "), name.size());
}
std::string what_of(const StabilityOutcome& one) {
    return one.name.substr(0, comma(one.name));
}
std::string scene_of(const StabilityOutcome& one) {
    return comma(one.name) == one.name.size() ? "" : one.name.substr(comma(one.name) + 2);
}

/// What is varied, with the y of its row, and the scenes, each with the x of its first cell; in the order they come.
struct Line {
    std::string text, group;
    int at;
};
struct Grid {
    std::vector<Line> row, scene;

    Grid(const std::vector<StabilityOutcome>& outcomes, int solvers) {
        int y = top, x = left;
        for (const StabilityOutcome& one : outcomes) {
            if (!find(row, what_of(one))) {
                if (!row.empty() && row.back().group != one.group) y += gap;
                row.push_back({what_of(one), one.group, y});
                y += row_height;
            }
            if (!find(scene, scene_of(one))) {
                scene.push_back({scene_of(one), "", x});
                x += width(scene_of(one), solvers) + gap;
            }
        }
    }
    /// Of a scene's cells, or of its name where that is wider.
    static int width(const std::string& scene, int solvers) {
        return std::max(solvers * cell_width, letter * static_cast<int>(scene.size()));
    }
    static const Line* find(const std::vector<Line>& lines, const std::string& text) {
        const auto found = std::find_if(lines.begin(), lines.end(), [&](const Line& one) { return one.text == text; });
        return found == lines.end() ? nullptr : &*found;
    }
};

void draw_legend(files::Picture& picture, const std::vector<std::string>& solver) {
    int x = margin;
    for (const Meaning& meaning : meanings) {
        generate::fill(picture, x, margin - 2, 12, 12, meaning.color);
        generate::write_text(picture, x + 16, margin, meaning.text);
        x += 16 + 7 * static_cast<int>(std::string(meaning.text).size()) + 12;
    }
    std::string text = "Seconds of each scene's drapes, all tries together; its columns:";
    for (const std::string& name : solver) text += (name == solver.front() ? " " : ", ") + name;
    generate::write_text(picture, margin, margin + 3 * row_height / 2, text);
}

/// Times in as few letters as a cell holds.
std::string time_text(double seconds) {
    return fmt::format("{:.{}f}", seconds, seconds < 10.0 ? 2 : seconds < 100.0 ? 1 : 0);
}

}  // namespace

files::Picture stability_picture(const std::vector<StabilityOutcome>& outcomes,
                                 const std::vector<std::string>& solver) {
    const int solvers = static_cast<int>(solver.size());
    const Grid grid(outcomes, solvers);
    const int right = grid.scene.empty() ? left : grid.scene.back().at + Grid::width(grid.scene.back().text, solvers);
    const int bottom = grid.row.empty() ? top : grid.row.back().at + row_height;
    files::Picture picture = generate::blank_picture(std::max(right, 780) + margin, bottom + margin);
    draw_legend(picture, solver);
    for (const Line& scene : grid.scene) generate::write_text(picture, scene.at, top - 3 * row_height / 2, scene.text);
    for (const Line& row : grid.row) generate::write_text(picture, margin, row.at + 2, row.text);
    for (const StabilityOutcome& one : outcomes) {
        const int column = static_cast<int>(std::find(solver.begin(), solver.end(), one.solver) - solver.begin());
        const int x = Grid::find(grid.scene, scene_of(one))->at + column * cell_width;
        const int y = Grid::find(grid.row, what_of(one))->at;
        const Verdict found = verdict(one);
        generate::fill(picture, x, y, cell_width - 2, row_height - 2, meanings[static_cast<size_t>(found)].color);
        if (found != Verdict::absent) generate::write_text(picture, x + 4, y + 1, time_text(one.certificate.seconds));
    }
    return picture;
}

}  // namespace toile::evaluate

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "evaluate/runtime.h"

namespace toile::evaluate {
namespace {

std::string cell_text(const StudyCell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    if (const auto* value = std::get_if<double>(&cell)) return short_number(*value);
    const Spread& spread = std::get<Spread>(cell);
    // Where there is no spread to speak of, one number says all.
    const bool alike = short_number(spread.low) == short_number(spread.high);
    if (alike || !std::isfinite(spread.low) || !std::isfinite(spread.high)) return short_number(spread.middle);
    return fmt::format("{} ({} to {})", short_number(spread.middle), short_number(spread.low),
                       short_number(spread.high));
}

std::string heading(const StudyColumn& column) {
    return column.unit.empty() ? column.name : column.name + ", " + column.unit;
}

std::string table_text(const StudyTable& table) {
    std::vector<std::vector<std::string>> line(1);
    for (const StudyColumn& column : table.column) line[0].push_back(heading(column));
    for (const std::vector<StudyCell>& row : table.row) {
        std::vector<std::string>& text = line.emplace_back();
        for (const StudyCell& cell : row) text.push_back(cell_text(cell));
    }
    std::string all = table.title + "\n";
    for (const std::vector<std::string>& row : line) {
        for (size_t c = 0; c < row.size(); ++c) {
            size_t width = 0;
            for (const std::vector<std::string>& other : line) width = std::max(width, other[c].size());
            all += fmt::format("{}{:<{}}", c == 0 ? "  " : "   ", row[c], c + 1 == row.size() ? 0 : width);
        }
        all += "\n";
    }
    return all;
}

}  // namespace

std::string runtime_table(const RuntimeSummary& summary) {
    std::string text;
    for (const Study& study : summary.study) {
        if (study.table.empty()) text += study.title + "\n";
        for (const StudyTable& table : study.table) text += table_text(table);
        for (const std::string& one : study.left_out) text += "  left out: " + one + "\n";
        text += "\n";
    }
    return text + fmt::format("{:.0f} s in all\n", summary.seconds);
}

}  // namespace toile::evaluate

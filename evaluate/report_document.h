#pragma once

#include <array>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

/// What a report says, as the page takes it. Evaluations make sections of it (`<kind>_section.h`), evaluate/report.h
/// puts them together. Numbers that are not finite are numbers that are not there, and become null.
namespace toile::evaluate {

inline constexpr double not_there = std::numeric_limits<double>::quiet_NaN();

/// A number with its 95 % interval, and a remark for who points at it.
struct Measured {
    double value = not_there;
    double low = not_there, high = not_there;
    std::string note{};
};

/// A table's cell: a text, a number, a measured number; nothing by default.
class ReportCell {
  public:
    using Value = std::variant<std::monostate, std::string, double, Measured>;

    ReportCell() = default;
    ReportCell(std::string text) : value_(std::move(text)) {}
    ReportCell(const char* text) : value_(std::string(text)) {}
    ReportCell(Measured number) : value_(std::move(number)) {}
    template <typename Number>
    requires std::is_arithmetic_v<Number> ReportCell(Number number) : value_(static_cast<double>(number)) {}

    const Value& value() const { return value_; }

  private:
    Value value_;
};

struct ReportColumn {
    enum class Align { text, number };
    std::string name;
    std::string unit;
    Align align = Align::number;
    int digits = 3;  ///< significant digits that numbers are shown with
};

struct ReportTable {
    std::string id, title, note;
    std::vector<ReportColumn> columns;
    std::vector<std::vector<ReportCell>> rows{};  ///< each as long as `columns`
};

struct ReportAxis {
    std::string label, unit;
    bool log = false;
};

struct ReportPoint {
    double x = not_there, y = not_there;
    double x_low = not_there, x_high = not_there, y_low = not_there, y_high = not_there;  ///< spread, where known
    std::string label{};                                                                  ///< "tolerance 1e-6"
};

struct ReportSeries {
    std::string name;
    std::vector<ReportPoint> points{};
};

struct ReportCurves {
    std::string id, title, note;
    ReportAxis x, y;
    std::vector<ReportSeries> series{};
};

struct ReportHistogram {
    struct Series {
        std::string name;
        std::vector<double> edges;   ///< [n + 1], rising
        std::vector<double> counts;  ///< [n]
    };
    std::string id, title, note;
    ReportAxis x;
    std::vector<Series> series{};
};

struct ReportPicture {
    std::string id, title, alt;
    std::string src;  ///< "data:image/png;base64,...": the page fetches nothing
};

/// Where the 3D view of the report's scene goes.
struct ReportViewer {
    std::string id, title;
};

using ReportBlock = std::variant<ReportTable, ReportCurves, ReportHistogram, ReportPicture, ReportViewer>;

struct ReportSection {
    std::string id, title;
    std::vector<std::string> text{};  ///< paragraphs, plain text
    std::vector<ReportBlock> blocks{};
};

struct ReportFact {
    std::string name, value;
};

/// Of the page without its scene and blobs (evaluate/report_scene.h).
struct ReportDocument {
    std::string title;
    std::vector<std::string> verdict;  ///< at most five lines
    std::vector<ReportFact> facts;
    std::vector<ReportSection> sections;
};

/// The page's JSON. Throws Error, naming the block by its id, for an id that is empty or there twice, a row that does
/// not fit its columns, edges and counts that do not fit, a picture that is no data URI, more than five lines of
/// verdict.
nlohmann::ordered_json as_json(const ReportDocument& document);

/// One section of it, checked likewise.
nlohmann::ordered_json as_json(const ReportSection& section);

}  // namespace toile::evaluate

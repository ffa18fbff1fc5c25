#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/report_document.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

ReportTable table() {
    ReportTable table{"t", "Errors", "in mm", {{"method", "", ReportColumn::Align::text, 3}, {"error", "mm"}}, {}};
    table.rows.push_back({"predicted", Measured{7.4, 7.1, 7.8, "64 samples"}});
    table.rows.push_back({std::string("projected"), 5});
    table.rows.push_back({"absent", {}});
    table.rows.push_back({"not a number", std::nan("")});
    return table;
}

/// What is wrong with a section of one block: "where: what".
std::string complaint(const ReportBlock& block) {
    try {
        as_json(ReportSection{"s", "Section", {}, {block}});
    } catch (const Error& error) {
        return error.where() + ": " + error.what();
    }
    return "none";
}

Json json_of(const ReportBlock& block) {
    return as_json(ReportSection{"s", "Section", {}, {block}}).at("blocks").at(0);
}

TEST(ReportDocument, a_table_is_what_the_page_takes) {
    EXPECT_EQ(json_of(table()), Json::parse(R"({
        "type": "table", "id": "t", "title": "Errors", "note": "in mm",
        "columns": [{"name": "method", "unit": "", "align": "text", "digits": 3},
                    {"name": "error", "unit": "mm", "align": "number", "digits": 3}],
        "rows": [["predicted", {"value": 7.4, "low": 7.1, "high": 7.8, "note": "64 samples"}],
                 ["projected", 5.0], ["absent", null], ["not a number", null]]})"));
}

TEST(ReportDocument, a_measured_number_that_is_not_finite_is_null) {
    ReportTable one{"t", "T", "", {{"a", ""}}, {{Measured{INFINITY, std::nan(""), 2, ""}}}};
    EXPECT_EQ(json_of(one).at("rows"), Json::parse(R"([[{"value": null, "low": null, "high": 2.0}]])"));
}

TEST(ReportDocument, curves_leave_out_the_spread_that_is_not_known) {
    ReportCurves curves{"c", "Error against time", "", {"time", "s", true}, {"error", "mm", false}, {}};
    curves.series.push_back({"prior", {{1, 2}, {3, std::nan(""), 2.5, 3.5, 0, 1, "tight"}}});
    EXPECT_EQ(json_of(curves), Json::parse(R"({
        "type": "curves", "id": "c", "title": "Error against time", "note": "",
        "x": {"label": "time", "unit": "s", "log": true}, "y": {"label": "error", "unit": "mm", "log": false},
        "series": [{"name": "prior", "points": [{"x": 1.0, "y": 2.0},
            {"x": 3.0, "y": null, "x_low": 2.5, "x_high": 3.5, "y_low": 0.0, "y_high": 1.0, "label": "tight"}]}]})"));
}

TEST(ReportDocument, histogram_picture_and_viewer_are_what_the_page_takes) {
    ReportHistogram histogram{"h", "Stretch", "", {"stretch", "", false}, {{"target", {0, 1, 2}, {5, 6}}}};
    EXPECT_EQ(json_of(histogram), Json::parse(R"({
        "type": "histogram", "id": "h", "title": "Stretch", "note": "",
        "x": {"label": "stretch", "unit": "", "log": false},
        "series": [{"name": "target", "edges": [0.0, 1.0, 2.0], "counts": [5.0, 6.0]}]})"));
    EXPECT_EQ(json_of(ReportPicture{"p", "Picture", "A shirt", "data:image/png;base64,AA=="}), Json::parse(R"({
        "type": "picture", "id": "p", "title": "Picture", "alt": "A shirt", "src": "data:image/png;base64,AA=="})"));
    EXPECT_EQ(json_of(ReportViewer{"v", "View"}), Json::parse(R"({"type": "viewer", "id": "v", "title": "View"})"));
}

TEST(ReportDocument, the_document_is_what_the_page_takes) {
    const ReportDocument document{"Report", {"Good."}, {{"data set", "a.h5"}}, {{"s", "S", {"One.", "Two."}, {}}}};
    EXPECT_EQ(as_json(document), Json::parse(R"({
        "title": "Report", "verdict": ["Good."], "facts": [{"name": "data set", "value": "a.h5"}],
        "sections": [{"id": "s", "title": "S", "text": ["One.", "Two."], "blocks": []}], "scene": null})"));
}

TEST(ReportDocument, one_defect_at_a_time) {
    EXPECT_EQ(complaint(table()), "none");
    ReportTable ragged = table();
    ragged.rows[1].pop_back();
    EXPECT_EQ(complaint(ragged), "t: a row of the table has 1 cells for 2 columns");
    EXPECT_EQ(complaint(ReportHistogram{"h", "H", "", {}, {{"a", {0, 1}, {1, 2}}}}),
              "h: a histogram has 2 edges for 2 counts");
    EXPECT_THAT(complaint(ReportPicture{"p", "P", "", "https://example.org/a.png"}), testing::StartsWith("p: "));
    EXPECT_THAT(complaint(ReportViewer{"", "View"}), testing::StartsWith("View: "));
    EXPECT_THAT(complaint(ReportViewer{"s", "View"}), testing::HasSubstr("the same id"));
    ReportDocument document{"Report", std::vector<std::string>(5, "line"), {}, {{"a", "A", {}, {}}}};
    EXPECT_NO_THROW(as_json(document));
    document.sections.push_back(document.sections[0]);
    EXPECT_THROW(as_json(document), Error);
    document.sections.pop_back();
    document.verdict.push_back("a sixth line");
    EXPECT_THROW(as_json(document), Error);
}

}  // namespace
}  // namespace toile::evaluate

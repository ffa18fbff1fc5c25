#include <gtest/gtest.h>

#include <string_view>

#include "evaluate/report_page.h"

namespace toile::evaluate {
namespace {

int occurrences(std::string_view text, std::string_view part) {
    int count = 0;
    for (auto at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) {
        ++count;
    }
    return count;
}

TEST(ReportPage, HoldsEachMarkerOnce) {
    EXPECT_EQ(occurrences(report_page(), "<!--TOILE_DATA-->"), 1);
    EXPECT_EQ(occurrences(report_page(), "<!--TOILE_BLOBS-->"), 1);
}

TEST(ReportPage, IsAWholePageWithItsScriptAndStyle) {
    EXPECT_TRUE(report_page().starts_with("<!doctype html>"));
    EXPECT_TRUE(report_page().find("</html>") != std::string_view::npos);
    EXPECT_GT(report_page().size(), 100'000u);
    EXPECT_EQ(occurrences(report_page(), "/* TOILE_S"), 0);  // what the bundler was to fill
}

TEST(ReportPage, RefersToNoOtherFile) {
    for (const std::string_view reference : {"<script src", "<link ", "@import"}) {
        EXPECT_EQ(occurrences(report_page(), reference), 0) << reference;
    }
}

TEST(ReportPage, PassesOnTheLicencesOfWhatItIsMadeWith) {
    for (const std::string_view name : {"three ", "echarts ", "zrender ", "tslib "}) {
        EXPECT_GE(occurrences(report_page(), name), 1) << name;
    }
    EXPECT_GE(occurrences(report_page(), "Permission is hereby granted"), 1);
}

}  // namespace
}  // namespace toile::evaluate

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "evaluate/filled_page.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* page_template = "<html><!--TOILE_DATA-->|<!--TOILE_BLOBS--></html>";

TEST(FilledPage, markers_are_replaced_by_data_and_blobs) {
    EXPECT_EQ(filled_page(page_template, Json{{"a", 1}}, {{"blob-0", "QQ=="}, {"blob-1", "Qg=="}}),
              "<html><script type=\"application/json\" id=\"data\">{\"a\":1}</script>|"
              "<script type=\"application/octet-stream\" id=\"blob-0\">QQ==</script>\n"
              "<script type=\"application/octet-stream\" id=\"blob-1\">Qg==</script>\n</html>");
}

TEST(FilledPage, no_text_ends_the_script_or_passes_for_a_marker) {
    const std::string hostile = "</script><script>alert(1)</script><!--TOILE_BLOBS--><!--";
    const std::string page = filled_page(page_template, Json{{hostile, hostile}}, {});
    const size_t begin = page.find("id=\"data\">") + 10, end = page.find("</script>", begin);
    const std::string json = page.substr(begin, end - begin);
    EXPECT_THAT(json, Not(HasSubstr("<")));
    EXPECT_EQ(Json::parse(json), (Json{{hostile, hostile}}));
    EXPECT_EQ(page.substr(end), "</script>|</html>");
}

TEST(FilledPage, a_file_name_that_is_no_utf8_does_not_break_it) {
    EXPECT_THAT(filled_page(page_template, Json{{"a", "caf\xE9"}}, {}), HasSubstr("caf\xEF\xBF\xBD"));
}

TEST(FilledPage, a_template_must_hold_each_marker_once) {
    for (const char* broken :
         {"", "<!--TOILE_DATA-->", "<!--TOILE_BLOBS-->", "<!--TOILE_DATA--><!--TOILE_DATA--><!--TOILE_BLOBS-->",
          "<!--TOILE_BLOBS--><!--TOILE_DATA-->"})
        EXPECT_THROW(filled_page(broken, Json::object(), {}), std::logic_error) << broken;
}

}  // namespace
}  // namespace toile::evaluate

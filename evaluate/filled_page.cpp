#include "evaluate/filled_page.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view data_marker = "<!--TOILE_DATA-->", blobs_marker = "<!--TOILE_BLOBS-->";

/// Inside a script element `<` is the one letter that can end it, or begin a comment; in JSON it stands in texts alone.
std::string escaped(const std::string& json) {
    std::string text;
    text.reserve(json.size() + json.size() / 64);
    for (const char c : json) {
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    }
    return text;
}

size_t place_of(std::string_view page, std::string_view marker) {
    const size_t place = page.find(marker);
    if (place == std::string_view::npos || page.find(marker, place + 1) != std::string_view::npos)
        throw std::logic_error("the report's template must hold " + std::string(marker) + " once");
    return place;
}

}  // namespace

std::string filled_page(std::string_view page_template, const Json& document, const std::vector<ReportBlob>& blobs) {
    const size_t data = place_of(page_template, data_marker), blob = place_of(page_template, blobs_marker);
    if (blob < data) throw std::logic_error("the report's template must hold its data before its blobs");
    // file names may be no UTF-8
    const std::string json = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string page(page_template.substr(0, data));
    page += "<script type=\"application/json\" id=\"data\">" + escaped(json) + "</script>";
    page += page_template.substr(data + data_marker.size(), blob - data - data_marker.size());
    for (const ReportBlob& one : blobs)
        page += "<script type=\"application/octet-stream\" id=\"" + one.id + "\">" + one.text + "</script>\n";
    page += page_template.substr(blob + blobs_marker.size());
    return page;
}

}  // namespace toile::evaluate

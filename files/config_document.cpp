#include "files/config_document.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace toile::files::detail {
namespace {

std::vector<std::string> split(const std::string& path) {
    std::vector<std::string> part;
    std::istringstream stream(path);
    for (std::string one; std::getline(stream, one, '.');) part.push_back(one);
    return part;
}

}  // namespace

const toml::node* ConfigDocument::find(const std::string& path) const {
    const toml::node* node = &tree;
    for (const std::string& part : split(path)) {
        const toml::table* table = node->as_table();
        node = table ? table->get(part) : nullptr;
        if (!node) return nullptr;
    }
    return node;
}

std::string ConfigDocument::where(const toml::node* node) const {
    if (!node || !node->source().path || node->source().begin.line == 0) return file;
    const std::string& source = *node->source().path;
    if (source != file) return source;
    return file + ":" + std::to_string(node->source().begin.line);
}

ConfigSection& ConfigDocument::section_of(const std::string& path) {
    for (ConfigSection& one : section)
        if (one.path == path) return one;
    section.push_back({path, {}, {}});
    return section.back();
}

std::string join(const std::string& path, std::string_view key) {
    return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string show(const toml::node& node) {
    std::ostringstream stream;
    node.visit([&](const auto& value) {
        if constexpr (toml::is_table<decltype(value)>)
            stream << "a table";
        else if constexpr (toml::is_array<decltype(value)>)
            stream << toml::toml_formatter(value);
        else if constexpr (toml::is_string<decltype(value)>)
            stream << quote(value.get());
        else if constexpr (toml::is_floating_point<decltype(value)>)
            stream << number_text(value.get());
        else
            stream << value;
    });
    std::string text = stream.str();
    for (char& c : text)
        if (c == '\n') c = ' ';
    if (text.size() > 80) text = text.substr(0, 77) + "...";
    return text;
}

std::string quote(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04X", static_cast<unsigned>(static_cast<unsigned char>(c)));
            quoted += code;
        } else {
            quoted += c;
        }
    }
    return quoted + "\"";
}

std::string number_text(double value) {
    if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value < 0 ? "-inf" : "inf";
    char buffer[64];
    const double size = std::abs(value);
    const bool plain = size == 0 || (size >= 1e-5 && size < 1e15);  // 0.0005, not 5e-04
    const auto end = plain ? std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed).ptr
                           : std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    std::string text(buffer, end);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

}  // namespace toile::files::detail

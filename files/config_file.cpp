#include "files/config_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cloth/error.h"
#include "files/config_document.h"
#include "files/digest.h"

namespace toile::files {

namespace fs = std::filesystem;
using detail::ConfigDocument;
using detail::ConfigEntry;
using detail::ConfigSection;
using detail::quote;

namespace {

constexpr size_t largest_config = 4 << 20;
// Each level of tables takes stack, in toml++ as here, and costs a dot.
constexpr std::ptrdiff_t most_dots = 20'000, most_override_dots = 20;

std::string read_text(const std::string& path) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status)) throw Error("there is no such configuration file", path);
    if (fs::is_directory(status)) throw Error("this is a folder, a configuration file is expected", path);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw Error("the configuration cannot be read: no permission", path);
    std::string text(largest_config + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(stream.gcount()));
    if (text.size() > largest_config) throw Error("this is larger than 4 MB: not a configuration", path);
    return text;
}

std::string first_line(std::string text) {
    return text.substr(0, text.find('\n'));
}

toml::table parse(const std::string& text, const std::string& source) {
    if (std::count(text.begin(), text.end(), '.') > most_dots)
        throw Error("this has more than " + std::to_string(most_dots) + " dots: not a configuration", source);
    try {
        return toml::parse(text, source);
    } catch (const toml::parse_error& error) {
        const auto line = error.source().begin.line;
        throw Error("not valid TOML: " + first_line(std::string(error.description())),
                    source + (line > 0 ? ":" + std::to_string(line) : ""));
    }
}

/// The value of an override: TOML if it reads as one value, else the bare text.
toml::table override_value(const std::string& text, const std::string& source) {
    try {
        toml::table parsed = toml::parse("value = " + text, source);
        if (parsed.size() == 1 && parsed.contains("value")) return parsed;
    } catch (const toml::parse_error&) {
        // not TOML: a bare word
    }
    return parse("value = " + quote(text), source);
}

void apply_override(toml::table& tree, const std::string& text) {
    const size_t equals = text.find('=');
    const std::string key = text.substr(0, equals), source = "--set " + key;
    const bool dots = key.empty() || key.front() == '.' || key.back() == '.' || key.find("..") != std::string::npos;
    if (equals == std::string::npos || dots)
        throw Error(quote(text) + " is not key=value", "--set", "write for example --set poses.count=4");
    if (std::count(key.begin(), key.end(), '.') > most_override_dots)
        throw Error("the key has more parts than any that is known", "--set " + key.substr(0, 40) + "...");
    toml::table* table = &tree;
    size_t begin = 0;
    for (size_t dot; (dot = key.find('.', begin)) != std::string::npos; begin = dot + 1) {
        const std::string name = key.substr(begin, dot - begin);
        toml::node* next = table->get(name);
        if (!next) next = &table->insert(name, parse("", source)).first->second;
        if (!next->is_table()) throw Error(key.substr(0, dot) + " is not a table", source);
        table = next->as_table();
    }
    toml::table value = override_value(text.substr(equals + 1), source);
    value.get("value")->visit([&](auto& node) { table->insert_or_assign(key.substr(begin), std::move(node)); });
}

/// Levenshtein distance.
size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
            diagonal = above;
        }
    }
    return row[b.size()];
}

std::string nearest_known(const std::string& key, const std::vector<std::string>& known) {
    std::string best, all;
    size_t best_distance = std::max<size_t>(2, key.size() / 2);
    for (const std::string& one : known) {
        all += (all.empty() ? "" : ", ") + one;
        const size_t distance = edit_distance(key, one);
        if (distance > best_distance) continue;
        if (distance < best_distance || best.empty()) best = one;
        best_distance = distance;
    }
    return (best.empty() ? "" : "did you mean " + best + "? ") + "known here: " + all;
}

void refuse_unknown(const ConfigDocument& document, const toml::table& table, const std::string& path) {
    std::vector<std::string> known;
    if (const auto found = document.known.find(path); found != document.known.end()) known = found->second;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    for (const auto& [key, node] : table) {
        const std::string name(key.str());
        const std::string full = detail::join(path, name);
        if (!std::binary_search(known.begin(), known.end(), name))
            throw Error((node.is_table() ? "unknown table [" : "unknown key ") + full + (node.is_table() ? "]" : ""),
                        document.where(&node), nearest_known(name, known));
        if (node.is_table()) refuse_unknown(document, *node.as_table(), full);
    }
}

std::string printed_value(const ConfigEntry& entry, ConfigFile::Paths paths) {
    return paths == ConfigFile::Paths::absolute && !entry.absolute.empty() ? entry.absolute : entry.value;
}

void print_section(std::ostream& stream, const ConfigSection& section, ConfigFile::Paths paths) {
    if (!section.path.empty()) stream << "\n[" << section.path << "]";
    if (!section.doc.empty()) stream << "  # " << section.doc;
    if (!section.path.empty()) stream << "\n";
    for (const ConfigEntry& entry : section.entry) {
        const std::string value = printed_value(entry, paths);
        if (value.empty())
            stream << "# " << entry.key << ": not given";
        else
            stream << entry.key << " = " << value;
        const std::string comment = entry.about + (entry.about.empty() || entry.doc.empty() ? "" : "; ") + entry.doc;
        if (!comment.empty()) stream << "  # " << comment;
        stream << "\n";
    }
}

}  // namespace

ConfigFile::ConfigFile(const std::string& path, const std::vector<std::string>& overrides)
    : ConfigFile(from_text(read_text(path), path, overrides)) {}

ConfigFile ConfigFile::from_text(const std::string& text, const std::string& source,
                                 const std::vector<std::string>& overrides) {
    ConfigFile config(std::vector<std::string>{});
    config.document_->file = source;
    config.document_->folder = fs::path(source).parent_path().string();
    config.document_->tree = parse(text, source);
    if (config.document_->tree.empty()) throw Error("the configuration is empty", source, "see configs/ for examples");
    for (const std::string& one : overrides) apply_override(config.document_->tree, one);
    return config;
}

ConfigFile::ConfigFile(const std::vector<std::string>& overrides) : document_(std::make_shared<ConfigDocument>()) {
    for (const std::string& one : overrides) apply_override(document_->tree, one);
}

ConfigTable ConfigFile::root() const {
    return ConfigTable(document_, "");
}

void ConfigFile::refuse_unknown_keys() const {
    refuse_unknown(*document_, document_->tree, "");
}

std::string ConfigFile::resolved(Paths paths) const {
    std::ostringstream stream;
    for (const ConfigSection& section : document_->section) print_section(stream, section, paths);
    const std::string text = stream.str();
    return text.substr(text.find_first_not_of('\n') == std::string::npos ? 0 : text.find_first_not_of('\n'));
}

std::string ConfigFile::hash() const {
    std::string text;
    for (const ConfigSection& section : document_->section) {
        text += "[" + section.path + "]\n";
        for (const ConfigEntry& entry : section.entry)
            text += entry.key + " = " + (entry.digest.empty() ? entry.value : entry.digest) + "\n";
    }
    return text_digest(text);
}

}  // namespace toile::files

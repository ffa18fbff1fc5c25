#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

// toml++ 3.3 asserts, and in release builds lets the optimiser assume, what malformed input breaks ("[a\n"); the error
// branches behind its assertions are right. So they are switched off, in every build type alike.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace toile::files::detail {

/// One resolved key, ready for printing.
struct ConfigEntry {
    std::string key;
    std::string value;     ///< as TOML; empty where the key is not given and has no default
    std::string absolute;  ///< for a path, the resolved path as TOML
    std::string digest;    ///< for a path, its file's XXH3-128
    std::string about;     ///< unit and bounds
    std::string doc;
};

struct ConfigSection {
    std::string path;  ///< "" for the root
    std::string doc;
    std::vector<ConfigEntry> entry;
};

/// What ConfigFile and its cursors share: the parsed tree and what has been read from it.
struct ConfigDocument {
    std::string file;
    std::string folder;
    toml::table tree;
    std::vector<ConfigSection> section;                     ///< in the order the cursors came by
    std::map<std::string, std::vector<std::string>> known;  ///< keys asked for, by table path

    const toml::node* find(const std::string& path) const;
    std::string where(const toml::node* node) const;
    ConfigSection& section_of(const std::string& path);
};

std::string join(const std::string& path, std::string_view key);
/// A value on one line, shortened, for messages.
std::string show(const toml::node& node);
std::string quote(std::string_view text);
std::string number_text(double value);

}  // namespace toile::files::detail

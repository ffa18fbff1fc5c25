#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace toile::files {

/// What is said about one key: the bounds of its value, its unit and one line of documentation.
struct ConfigField {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    bool above = false;  ///< the value must be greater than `lower`, not equal to it
    std::string_view unit = {};
    std::string_view doc = {};
};

/// A word of a configuration that stands for a value of an enumeration.
template <class Value>
using ConfigChoices = std::vector<std::pair<std::string_view, Value>>;

/// A path written in a configuration: `written` as it stands there, `resolved` from the configuration's own folder
/// (from the working folder when it came from an override). Both are empty where none was given.
struct ConfigPath {
    std::string written;
    std::string resolved;
};

namespace detail {
struct ConfigDocument;
}

/// A cursor on one table. Every call names a key, its place in the options struct (which holds the default) and what is
/// allowed; a value that is given is checked and stored, and either way the resolved value is recorded for printing.
/// All of them throw Error with where = `file:line` (or `--set key`), naming key, value and what is allowed.
class ConfigTable {
  public:
    ConfigTable(std::shared_ptr<detail::ConfigDocument> document, std::string path);

    /// The table below this one, or nothing where it is absent; Error if `name` is there and not a table.
    std::optional<ConfigTable> table(std::string_view name, std::string_view doc);
    /// The same for a table whose absence means that all of its keys have their defaults.
    ConfigTable section(std::string_view name, std::string_view doc);

    void real(std::string_view key, double& value, const ConfigField& field);
    void real(std::string_view key, std::optional<double>& value, const ConfigField& field);
    void integer(std::string_view key, int& value, const ConfigField& field);
    /// An integer, or `word` for "not given": then `value` is empty.
    void integer_or(std::string_view key, std::optional<int>& value, std::string_view word, const ConfigField& field);
    void seed(std::string_view key, std::uint64_t& value, std::string_view doc);
    void boolean(std::string_view key, bool& value, std::string_view doc);
    void text(std::string_view key, std::string& value, std::string_view doc);
    /// A file that must be there and be readable.
    void path(std::string_view key, ConfigPath& value, std::string_view doc);
    void vector(std::string_view key, Eigen::Vector3d& value, const ConfigField& field);
    /// Two numbers, the lower first: `[lower, upper]`.
    void interval(std::string_view key, double& lower, double& upper, const ConfigField& field);
    void integers(std::string_view key, std::vector<int>& value, const ConfigField& field);
    void reals(std::string_view key, std::vector<double>& value, const ConfigField& field);
    void texts(std::string_view key, std::vector<std::string>& value, std::string_view doc);
    /// Some of these words, none or all of them.
    void choices(std::string_view key, std::vector<std::string>& value, const std::vector<std::string>& allowed,
                 std::string_view doc);

    template <class Value>
    void choice(std::string_view key, Value& value, const ConfigChoices<Value>& allowed, std::string_view doc) {
        std::vector<std::string> word;
        std::string chosen;
        for (const auto& [name, meaning] : allowed) {
            word.emplace_back(name);
            if (meaning == value) chosen = name;
        }
        const size_t index = choose(key, chosen, word, doc);
        if (index < allowed.size()) value = allowed[index].second;
    }

    /// The keys that stand in this table, known or not: for tables whose keys are names.
    std::vector<std::string> keys() const;
    bool has(std::string_view key) const;
    /// The place of a key, or of the table where the key is absent: `file:line` or `--set key`.
    std::string where(std::string_view key = {}) const;
    /// The full name of a key: `body.height`.
    std::string name(std::string_view key) const;
    /// Throws Error `<full key> <what>` at the key's place.
    [[noreturn]] void fail(std::string_view key, const std::string& what, const std::string& mend = {}) const;

  private:
    void texts_of(std::string_view key, std::vector<std::string>& value);
    size_t choose(std::string_view key, const std::string& value, const std::vector<std::string>& allowed,
                  std::string_view doc);
    void record(std::string_view key, std::string value, std::string about, std::string_view doc);

    std::shared_ptr<detail::ConfigDocument> document_;
    std::string path_;
};

/// One configuration: TOML text with overrides laid over it. Reading it is strict: what no cursor asked for is an
/// error.
class ConfigFile {
  public:
    /// Reads `path`; each override is `key.path=value`, its value TOML or else a bare word. Throws Error for a file
    /// that is missing, empty, unreadable, not TOML, or larger than 4 MB, and for an override that is malformed.
    ConfigFile(const std::string& path, const std::vector<std::string>& overrides);
    /// The same for text that was read from elsewhere: `source` stands for the file in messages, and the folder that
    /// relative paths start from is its own.
    static ConfigFile from_text(const std::string& text, const std::string& source,
                                const std::vector<std::string>& overrides);
    /// A configuration without a file: defaults and overrides.
    explicit ConfigFile(const std::vector<std::string>& overrides);

    ConfigTable root() const;
    /// Throws Error for the first key that no cursor has asked for, with the nearest known one as the mend.
    void refuse_unknown_keys() const;

    enum class Paths { written, absolute };
    /// The resolved configuration as TOML, every key with its unit, bounds and documentation as a comment.
    std::string resolved(Paths paths) const;
    /// XXH3-128, in hexadecimal, of the resolved values, without comments and with each path replaced by its file's
    /// contents: it does not change when files move, and does when they change.
    std::string hash() const;

  private:
    std::shared_ptr<detail::ConfigDocument> document_;
};

}  // namespace toile::files

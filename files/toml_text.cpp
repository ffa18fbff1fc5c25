#include "files/toml_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "cloth/error.h"

namespace toile::files {
namespace {

constexpr std::ptrdiff_t most_dots = 20'000;

/// Walks through TOML from quote to quote.
class TomlScanner {
  public:
    TomlScanner(const std::string& text, const std::string& source) : text_(text), source_(source) {}

    void scan() {
        if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '#')
                at_ = std::min(text_.find_first_of("\n\v\f\r", at_), text_.size());
            else if ((c == '"' || c == '\'') && may_begin_text())
                skip_quoted(c);
            else
                step_ascii();
        }
    }

  private:
    /// A quote inside a bare word is none: toml++ reads on to the end of the word.
    bool may_begin_text() const {
        return at_ == 0 || std::string_view(" \t\n\v\f\r=,.[{").find(text_[at_ - 1]) != std::string_view::npos;
    }

    void step_ascii() {
        if (static_cast<unsigned char>(text_[at_]) >= 0x80)
            throw Error("not valid TOML: a character stands here that is not ASCII",
                        source_ + ":" + std::to_string(std::count(text_.begin(), text_.begin() + at_, '\n') + 1),
                        "texts stand in quotes");
        ++at_;
    }

    void skip_quoted(char quote) {
        const std::string three(3, quote);
        const bool lines = text_.compare(at_, 3, three) == 0;
        at_ += lines ? 3 : 1;
        while (at_ < text_.size()) {
            if (quote == '"' && text_[at_] == '\\') {
                skip_escape(lines);
            } else if (lines && text_.compare(at_, 3, three) == 0) {
                at_ += 3;
                for (int more = 0; more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) ++at_;
                return;
            } else if (!lines && (text_[at_] == quote || text_[at_] == '\n')) {
                ++at_;
                return;
            } else {
                ++at_;
            }
        }
    }

    void skip_escape(bool lines) {
        const auto is_space = [&] {
            return at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]));
        };
        ++at_;
        if (lines && is_space()) {
            while (is_space()) ++at_;
            if (at_ < text_.size() && text_[at_] != '"' && text_[at_] != '\\') step_ascii();
        } else if (lines && at_ < text_.size()) {
            step_ascii();
        } else {
            ++at_;
        }
    }

    const std::string& text_;
    const std::string& source_;
    size_t at_ = 0;
};

}  // namespace

void check_toml_text(const std::string& text, const std::string& source) {
    if (std::count(text.begin(), text.end(), '.') > most_dots)
        throw Error("this has more than " + std::to_string(most_dots) + " dots: not a configuration", source);
    TomlScanner(text, source).scan();
}

}  // namespace toile::files

#include "files/obj_text.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "cloth/error.h"

namespace toile::files {
namespace {

/// What has been seen of the file so far.
struct ObjChecker {
    const std::string& path;
    long line = 0;
    std::vector<long> vertex_line;  // where each position was given
    std::vector<bool> used;
    long textures = 0;
    long faces = 0;

    [[noreturn]] void fail(const std::string& what, long at) const {
        throw Error(what, path + ":" + std::to_string(at));
    }

    void check_numbers(std::istringstream& words, int needed, const char* kind) const {
        std::string word;
        for (int count = 0; words >> word; ++count) {
            const char* first = word.data() + (word[0] == '+');
            double value = 0;
            const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
            if (count >= needed) continue;  // weights and colours may follow
            if (error != std::errc() || end != word.data() + word.size())
                fail("'" + word.substr(0, 40) + "' is no coordinate of a " + kind, line);
            if (!std::isfinite(value)) fail(std::string("a coordinate of a ") + kind + " is not finite", line);
            if (count + 1 == needed) return;
        }
        fail(std::string("a ") + kind + " needs " + std::to_string(needed) + " coordinates", line);
    }

    /// One of the numbers of "7/3/1", counted from zero; negative ones count from the last given.
    long index(std::string_view text, long available, const char* kind) const {
        long number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc() || end != text.data() + text.size())
            fail("'" + std::string(text.substr(0, 40)) + "' is no corner of a face", line);
        const long at = number < 0 ? available + number : number - 1;
        if (at < 0 || at >= available)
            fail("a face refers to " + std::string(kind) + " " + std::to_string(number) + " of " +
                     std::to_string(available),
                 line);
        return at;
    }

    void check_face(std::istringstream& words) {
        std::string corner;
        while (words >> corner) {
            const std::string_view text = corner;
            const size_t slash = text.find('/');
            used[index(text.substr(0, slash), static_cast<long>(used.size()), "vertex")] = true;
            if (slash == std::string_view::npos) continue;
            const std::string_view rest = text.substr(slash + 1);
            const std::string_view texture = rest.substr(0, rest.find('/'));
            if (!texture.empty()) index(texture, textures, "texture coordinate");
        }
        ++faces;
    }

    void read(const std::string& content) {
        std::istringstream words(content);
        std::string keyword;
        if (!(words >> keyword)) return;
        if (keyword == "v") {
            check_numbers(words, 3, "vertex");
            vertex_line.push_back(line);
            used.push_back(false);
        } else if (keyword == "vt") {
            check_numbers(words, 2, "texture coordinate");
            ++textures;
        } else if (keyword == "f" || keyword == "fo") {
            check_face(words);
        } else if (keyword == "l" || keyword == "p") {
            check_face(words);
            --faces;
        }
    }
};

}  // namespace

void check_obj_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    ObjChecker checker{path, 0, {}, {}, 0, 0};
    std::string content, continued;
    while (std::getline(file, content)) {
        ++checker.line;
        if (!content.empty() && content.back() == '\r') content.pop_back();
        if (!content.empty() && content.back() == '\\') {
            content.back() = ' ';
            continued += content;
            continue;
        }
        checker.read(continued + content);
        continued.clear();
    }
    if (checker.faces == 0) throw Error("the file has no faces", path);
    for (size_t v = 0; v < checker.used.size(); ++v)
        if (!checker.used[v])
            checker.fail("vertex " + std::to_string(v + 1) + " belongs to no face", checker.vertex_line[v]);
}

}  // namespace toile::files

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
    std::vector<double> position;        // three a vertex
    std::vector<int> triangle;           // three corners each
    std::vector<long> corner_of_face{};  // of the line at hand

    [[noreturn]] void fail(const std::string& what, long at) const {
        throw Error(what, path + ":" + std::to_string(at));
    }

    /// Appends the numbers to `kept`, if there is one.
    void check_numbers(std::istringstream& words, int needed, const char* kind, std::vector<double>* kept) const {
        std::string word;
        for (int count = 0; words >> word; ++count) {
            const char* first = word.data() + (word[0] == '+');
            double value = 0;
            const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
            if (count >= needed) continue;  // weights and colours may follow
            if (error != std::errc() || end != word.data() + word.size())
                fail("'" + word.substr(0, 40) + "' is no coordinate of a " + kind, line);
            if (!std::isfinite(value)) fail(std::string("a coordinate of a ") + kind + " is not finite", line);
            if (kept) kept->push_back(value);
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
        corner_of_face.clear();
        while (words >> corner) {
            const std::string_view text = corner;
            const size_t slash = text.find('/');
            corner_of_face.push_back(index(text.substr(0, slash), static_cast<long>(used.size()), "vertex"));
            used[corner_of_face.back()] = true;
            if (slash == std::string_view::npos) continue;
            const std::string_view rest = text.substr(slash + 1);
            const std::string_view texture = rest.substr(0, rest.find('/'));
            if (!texture.empty()) index(texture, textures, "texture coordinate");
        }
        ++faces;
    }

    void keep_triangles() {
        for (size_t k = 2; k < corner_of_face.size(); ++k)
            for (const size_t corner : {size_t{0}, k - 1, k})
                triangle.push_back(static_cast<int>(corner_of_face[corner]));
    }

    void read(const std::string& content) {
        std::istringstream words(content);
        std::string keyword;
        if (!(words >> keyword)) return;
        if (keyword == "v") {
            check_numbers(words, 3, "vertex", &position);
            vertex_line.push_back(line);
            used.push_back(false);
        } else if (keyword == "vt") {
            check_numbers(words, 2, "texture coordinate", nullptr);
            ++textures;
        } else if (keyword == "f" || keyword == "fo") {
            check_face(words);
            keep_triangles();
        } else if (keyword == "l" || keyword == "p") {
            check_face(words);
            --faces;
        }
    }
};

/// Reads the file through; all but vertices without a face is checked.
void read_lines(ObjChecker& checker) {
    std::ifstream file(checker.path, std::ios::binary);
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
    if (checker.faces == 0) throw Error("the file has no faces", checker.path);
}

}  // namespace

void check_obj_text(const std::string& path) {
    ObjChecker checker{path, 0, {}, {}, 0, 0, {}, {}};
    read_lines(checker);
    for (size_t v = 0; v < checker.used.size(); ++v)
        if (!checker.used[v])
            checker.fail("vertex " + std::to_string(v + 1) + " belongs to no face", checker.vertex_line[v]);
}

ObjShape read_obj_shape(const std::string& path) {
    ObjChecker checker{path, 0, {}, {}, 0, 0, {}, {}};
    read_lines(checker);
    ObjShape shape;
    shape.position = Eigen::Map<const Positions>(checker.position.data(), checker.position.size() / 3, 3);
    shape.triangle = Eigen::Map<const Triangles>(checker.triangle.data(), checker.triangle.size() / 3, 3);
    return shape;
}

}  // namespace toile::files

#include "files/ply_header.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string_view>

#include "cloth/error.h"

namespace toile::files {
namespace {

constexpr size_t longest_header = 1 << 16;

}  // namespace

void check_ply_header(const std::string& path) {
    constexpr std::array<std::string_view, 6> known = {"ply", "format", "comment", "obj_info", "element", "property"};
    std::string text(longest_header, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(file.gcount()));
    std::replace(text.begin(), text.end(), '\r', '\n');
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string keyword;
        if (!(words >> keyword)) continue;
        if (keyword == "end_header") return;
        if (std::find(known.begin(), known.end(), keyword) == known.end())
            throw Error("the header of the PLY file has a line that is none of the format's", path,
                        "export the mesh again");
    }
    throw Error("the header of the PLY file has no end", path, "export the mesh again");
}

}  // namespace toile::files

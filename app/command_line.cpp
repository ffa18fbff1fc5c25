#include "app/command_line.h"

#include <algorithm>
#include <cctype>

namespace toile::app {
namespace {

std::string kept;

bool is_plain(char one) {
    return std::isalnum(static_cast<unsigned char>(one)) || std::string("_-+=.,:/%@").find(one) != std::string::npos;
}

std::string quoted(const std::string& word) {
    if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
    std::string text = "'";
    for (const char one : word) text += one == '\'' ? std::string("'\\''") : std::string(1, one);
    return text + "'";
}

}  // namespace

void keep_command_line(int argc, const char* const* argv) {
    kept = "toile";
    for (int i = 1; i < argc; ++i) kept += " " + quoted(argv[i]);
}

const std::string& command_line() {
    return kept;
}

}  // namespace toile::app

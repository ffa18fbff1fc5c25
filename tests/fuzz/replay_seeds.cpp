// Stands in for libFuzzer's main: gives a harness each file of the folders named on the command line.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> seed;
    for (int i = 1; i < argc; ++i)
        for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
            if (entry.is_regular_file()) seed.push_back(entry.path());
    std::sort(seed.begin(), seed.end());
    for (const std::filesystem::path& one : seed) {
        std::printf("%s\n", one.c_str());
        std::fflush(stdout);  // the last line names what broke the reader
        std::ifstream file(one, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%zu inputs\n", seed.size());
    return seed.empty() ? 1 : 0;
}

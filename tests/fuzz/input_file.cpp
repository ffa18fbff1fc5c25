#include "tests/fuzz/input_file.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"

namespace toile::fuzz {
namespace {

[[noreturn]] void give_up(const std::string& what) {
    std::fprintf(stderr, "fuzz: %s\n", what.c_str());
    std::abort();
}

/// In memory where that can be had: journals sync what they write.
std::filesystem::path fast_folder() {
    std::error_code failure;
    return std::filesystem::is_directory("/dev/shm", failure) ? "/dev/shm" : std::filesystem::temp_directory_path();
}

}  // namespace

InputFile::InputFile(const std::string& extension) : folder_((fast_folder() / "toile_fuzz_XXXXXX").string()) {
    if (!mkdtemp(folder_.data())) give_up("cannot make a folder " + folder_);
    path_ = folder_ + "/input" + extension;
}

InputFile::~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

const std::string& InputFile::write(const uint8_t* data, size_t size) const {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    file.close();
    if (!file) give_up("cannot write " + path_);
    return path_;
}

void may_refuse(const std::function<void()>& read, Place place) {
    try {
        read();
    } catch (const Error& error) {
        const std::string what = error.what();
        if (what.empty() || (place == Place::known && error.where().empty()))
            give_up("refused without saying what or where: " + what);
    }
}

}  // namespace toile::fuzz

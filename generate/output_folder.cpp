#include "generate/output_folder.h"

#include <unistd.h>

#include <filesystem>

#include "cloth/error.h"

namespace toile::generate {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& path, For purpose) : path_(path) {
    if (path.empty()) throw Error("the output folder has no name", "--out");
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (fs::exists(status) && !fs::is_directory(status)) throw Error("a file is in the way of the output folder", path);
    if (purpose == For::dataset && fs::exists(fs::path(path) / "dataset.h5", failure))
        throw Error("this folder holds a data set already", path,
                    "choose another --out, or remove " + file("dataset.h5"));
    if (!fs::exists(status)) {
        for (fs::path above = fs::absolute(path); !fs::exists(above, failure); above = above.parent_path())
            made_.push_back(above.string());
        fs::create_directories(path, failure);
        if (failure) throw Error("the output folder cannot be made: " + failure.message(), path);
    }
    if (::access(path.c_str(), W_OK | X_OK) != 0)
        throw Error("the output folder cannot be written to", path, "choose a folder you may write to");
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    for (const std::string& folder : made_) fs::remove(folder, ignored);  // refuses unless it is empty
}

ScratchFile::~ScratchFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
}

std::string OutputFolder::file(const std::string& name) const {
    return (fs::path(path_) / name).string();
}

}  // namespace toile::generate

#include "files/new_folder.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {

namespace fs = std::filesystem;

NewFolder::NewFolder(const std::string& path) : path_((fs::path(path) / "").parent_path().string()) {
    if (path_.empty()) throw Error("the folder to write has no name", "--out");
    partial_ = path_ + ".partial";
    std::error_code failure;
    const fs::file_status status = fs::status(path_, failure);
    if (fs::exists(status) && !fs::is_directory(status))
        throw Error("a file is in the way of the folder", path_, "choose another name");
    if (fs::is_directory(status) && !fs::is_empty(path_, failure))
        throw Error("the folder is there already and not empty", path_, "choose another name, or remove it");
    if (::mkdir(partial_.c_str(), 0777) == 0) return;
    if (errno == EEXIST)
        throw Error("another run is writing this folder, or was broken off", partial_,
                    "remove it if nothing writes it");
    throw Error("cannot make the folder: " + write_failure(errno), path_, "choose a folder you may write to");
}

NewFolder::~NewFolder() {
    std::error_code ignored;
    if (!committed_) fs::remove_all(partial_, ignored);
}

std::string NewFolder::file(const std::string& name) const {
    return (fs::path(partial_) / name).string();
}

void NewFolder::commit() {
    // rename() replaces an empty folder
    if (std::rename(partial_.c_str(), path_.c_str()) != 0)
        throw Error("cannot make the folder: " + write_failure(errno), path_, "choose a folder you may write to");
    committed_ = true;
}

}  // namespace toile::files

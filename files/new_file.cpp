#include "files/new_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "cloth/error.h"

namespace toile::files {
namespace {

[[noreturn]] void fail(int error_number, const std::string& path) {
    throw Error("cannot write the file: " + write_failure(error_number), path,
                error_number == ENOSPC || error_number == EDQUOT ? "make room, or write to another disk"
                                                                 : "choose a folder you may write to");
}

/// Returns an error number, or 0. Of a folder that can be written to but not read, and of files that cannot be synced,
/// nothing more can be had.
int sync(const std::string& path, int flags) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
    if (descriptor < 0) return errno == EACCES ? 0 : errno;
    const int error = ::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP ? errno : 0;
    ::close(descriptor);
    return error;
}

std::string folder_of(const std::string& path) {
    const size_t slash = path.rfind('/');
    return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

}  // namespace

void sync_folder_of(const std::string& path) {
    if (const int error = sync(folder_of(path), O_RDONLY | O_DIRECTORY)) fail(error, path);
}

void write_text_file(const std::string& path, const std::string& text, NewFile::Survives survives) {
    NewFile file(path, survives);
    file.write(text.data(), text.size());
    file.commit();
}

std::string write_failure(int error_number) {
    switch (error_number) {
        case ENOSPC:
            return "the disk is full";
        case EDQUOT:
            return "the disk quota is used up";
        case EFBIG:
            return "the file would exceed the largest size allowed";
        case EACCES:
        case EPERM:
            return "no permission to write here";
        case EROFS:
            return "the disk is read-only";
        case ENOENT:
            return "the folder does not exist";
        case ENOTDIR:
            return "a part of the path is not a folder";
        case EISDIR:
            return "a folder has this name";
        default:
            return std::strerror(error_number);
    }
}

NewFile::NewFile(std::string path, Survives survives)
    : path_(std::move(path)), partial_(path_ + ".partial"), survives_(survives) {
    struct stat status {};
    if (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) fail(EISDIR, path_);
    const int descriptor = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(errno, path_);
    ::close(descriptor);
}

NewFile::~NewFile() {
    if (!committed_) ::unlink(partial_.c_str());
}

void NewFile::write(const void* data, size_t size) {
    const int descriptor = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(errno, path_);
    int error = 0;
    for (size_t done = 0; done < size && error == 0;) {
        const ssize_t put = ::write(descriptor, static_cast<const char*>(data) + done, size - done);
        if (put > 0)
            done += static_cast<size_t>(put);
        else if (put == 0 || errno != EINTR)
            error = put == 0 ? ENOSPC : errno;
    }
    if (error == 0 && survives_ == Survives::power_cut && ::fsync(descriptor) != 0 && errno != EINVAL) error = errno;
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (error != 0) fail(error, path_);
}

void NewFile::commit() {
    if (survives_ == Survives::power_cut)
        if (const int error = sync(partial_, O_WRONLY)) fail(error, path_);
    if (std::rename(partial_.c_str(), path_.c_str()) != 0) fail(errno, path_);
    committed_ = true;
    if (survives_ == Survives::power_cut) sync_folder_of(path_);
}

}  // namespace toile::files

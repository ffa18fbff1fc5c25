#include "files/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

int open_lock(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) throw Error("cannot make the lock: " + write_failure(errno), path);
    return descriptor;
}

/// False where another process holds it.
bool lock(int descriptor, int how, const std::string& path) {
    while (::flock(descriptor, how) != 0) {
        if (errno == EINTR) continue;
        if (errno == EWOULDBLOCK) return false;
        const std::string reason = write_failure(errno);
        ::close(descriptor);
        throw Error("cannot lock the file: " + reason, path, "use a file system that supports flock");
    }
    return true;
}

}  // namespace

std::optional<FileLock> FileLock::try_take(const std::string& path) {
    const int descriptor = open_lock(path);
    if (lock(descriptor, LOCK_EX | LOCK_NB, path)) return FileLock(descriptor);
    ::close(descriptor);
    return std::nullopt;
}

FileLock FileLock::take(const std::string& path) {
    const int descriptor = open_lock(path);
    lock(descriptor, LOCK_EX, path);
    return FileLock(descriptor);
}

bool FileLock::is_held(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool is_free = lock(descriptor, LOCK_SH | LOCK_NB, path);
    ::close(descriptor);
    return !is_free;
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

}  // namespace toile::files

#pragma once

#include <optional>
#include <string>

namespace toile::files {

/// An exclusive lock that a process holds by an open file; the system gives it back when the process ends, however it
/// ends. Held with flock(2): it also works across machines on file systems that support that (NFS since Linux 2.6.12,
/// Lustre mounted with `flock`).
class FileLock {
  public:
    /// Nothing where another process holds it. Makes the file. Throws Error where it cannot be made.
    static std::optional<FileLock> try_take(const std::string& path);
    /// Waits for it.
    static FileLock take(const std::string& path);
    /// Whether a process holds it; false where the file is not there.
    static bool is_held(const std::string& path);

    ~FileLock();
    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&& other) noexcept;

    /// What a child process must close, so that the lock does not outlive its owner.
    int descriptor() const { return descriptor_; }

  private:
    explicit FileLock(int descriptor) : descriptor_(descriptor) {}
    int descriptor_;
};

}  // namespace toile::files

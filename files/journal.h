#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace toile::files {

/// Records that survive the death of the process and of the machine: a file that is only ever appended to, each record
/// with its length and digest, on the disk when `append` returns. HDF5 files cannot do that: killed while it writes,
/// one is lost whole. One process at a time.
///
/// What a kill or a full disk leaves unfinished at the end is cut off when the journal is opened again; a record that
/// was damaged later is passed over.
class Journal {
  public:
    /// Opens `path`, or makes it. Throws Error where it cannot be read or written.
    explicit Journal(std::string path);
    ~Journal();
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&& other) noexcept;

    int count() const { return static_cast<int>(record_.size()); }
    int damaged() const { return damaged_; }  ///< records that were passed over
    std::string read(int record) const;       ///< throws Error where it is not what was written
    /// Throws Error with the system's reason (full disk, no permission); the journal is then as it was before.
    void append(std::string_view payload);
    const std::string& path() const { return path_; }

  private:
    struct Place {
        std::int64_t offset = 0, size = 0;  ///< of the payload [bytes]
    };
    void find_records();
    [[noreturn]] void fail(int error_number) const;

    std::string path_;
    int descriptor_ = -1;
    std::int64_t end_ = 0;
    std::vector<Place> record_;
    int damaged_ = 0;
};

}  // namespace toile::files

#pragma once

#include <string>

namespace toile::files {

/// A file that appears whole or not at all, a power cut included: it is written as `PATH.partial`; `commit` syncs it,
/// renames it to PATH and syncs the folder. Without a commit the partial file is removed.
class NewFile {
  public:
    enum class Survives { power_cut, kill };  ///< the latter is written without syncing: for what is soon replaced
    /// Throws Error where the folder is missing or not writable, or PATH is a folder.
    explicit NewFile(std::string path, Survives survives = Survives::power_cut);
    ~NewFile();
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    const std::string& path() const { return path_; }        ///< the final name
    const std::string& partial() const { return partial_; }  ///< the name to write to until then
    void commit();                                           ///< throws Error if the system refuses

    /// Writes `size` bytes to the partial file, replacing what it held, and syncs it. Throws Error with the system's
    /// reason (full disk, no permission).
    void write(const void* data, size_t size);

  private:
    std::string path_, partial_;
    Survives survives_;
    bool committed_ = false;
};

/// Writes a whole file of text. Throws Error with the system's reason.
void write_text_file(const std::string& path, const std::string& text,
                     NewFile::Survives survives = NewFile::Survives::power_cut);

/// Puts a file's entry in its folder on the disk: a file that was just made is there after a power cut. Throws Error
/// with the system's reason.
void sync_folder_of(const std::string& path);

/// One line for what a failed system call left in errno: "the disk is full", "no permission to write here" ...
std::string write_failure(int error_number);

}  // namespace toile::files

#pragma once

#include <string>

namespace toile::files {

/// A folder that appears whole or not at all: its files are written into `PATH.partial`, which is renamed to PATH by
/// `commit`. Without a commit the partial folder is removed with all that is in it.
class NewFolder {
  public:
    /// Throws Error where PATH is a file, or a folder that holds something, where PATH.partial is there already, or
    /// where the folder above is missing or not writable.
    explicit NewFolder(const std::string& path);
    ~NewFolder();
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;

    std::string file(const std::string& name) const;  ///< the path to write a file to until the commit
    void commit();                                    ///< throws Error if the rename fails

  private:
    std::string path_, partial_;
    bool committed_ = false;
};

}  // namespace toile::files

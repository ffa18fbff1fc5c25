#pragma once

#include <string>
#include <utility>
#include <vector>

namespace toile::generate {

/// The folder of a data set, or of results. Made on construction if it is not there, with those above it; removed again
/// on destruction as far as it was made here and is still empty. Throws Error where it cannot be made or written to, a
/// file is in the way, or a data set is to be made and it holds one already.
class OutputFolder {
  public:
    enum class For { dataset, results };
    explicit OutputFolder(const std::string& path, For purpose = For::dataset);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    std::string file(const std::string& name) const;  ///< the path of a file in it

  private:
    std::string path_;
    std::vector<std::string> made_;  ///< folders made here, the innermost first
};

/// Removes a file when it goes out of scope.
class ScratchFile {
  public:
    explicit ScratchFile(std::string path) : path_(std::move(path)) {}
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

  private:
    std::string path_;
};

}  // namespace toile::generate

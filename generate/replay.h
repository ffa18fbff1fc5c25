#pragma once

#include <memory>
#include <string>
#include <vector>

#include "files/replay_file.h"
#include "generate/output_folder.h"
#include "generate/sample.h"
#include "generate/validate.h"

namespace toile::generate {

/// What is kept of a sample that failed, to run it again; null for one that was accepted.
std::unique_ptr<files::ReplayRecord> replay_record(const DressedScene& dressed, const Sample& sample);

/// The folder `replay` beside a data set. Made with the first replay; on destruction it and its files are removed again
/// unless `keep` was called.
class ReplayFolder {
  public:
    explicit ReplayFolder(const OutputFolder& folder) : path_(folder.file("replay")) {}
    ~ReplayFolder();
    ReplayFolder(const ReplayFolder&) = delete;
    ReplayFolder& operator=(const ReplayFolder&) = delete;

    /// Writes pose_000123.h5 and returns its path.
    std::string write(const files::ReplayRecord& record);
    void keep() { written_.clear(); }

  private:
    std::string path_;
    std::vector<std::string> written_;
};

/// Whether a replay can be read, names a reason, and its tries and certificate agree. It is not run.
Validation validate_replay(const std::string& path);

/// A replay run again.
struct Replayed {
    files::ReplayRecord recorded;
    simulate::DrapeResult drape;
    bool same_inputs = false;       ///< configuration and files are what they were
    bool same_cloth = false;        ///< bit for bit
    bool same_certificate = false;  ///< but for the time
};

/// Runs a replay again and writes the cloth as .obj, .ply or .glb, as `simulate_once` does. With overrides it is
/// another configuration, and may well come out better.
Replayed replay_once(const std::string& replay, const std::vector<std::string>& overrides, const std::string& path);

}  // namespace toile::generate

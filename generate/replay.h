#pragma once

#include <memory>
#include <string>
#include <vector>

#include "files/replay_file.h"
#include "generate/sample.h"
#include "generate/validate.h"

namespace toile::generate {

/// What is kept of a sample that failed, to run it again; null for one that was accepted.
std::unique_ptr<files::ReplayRecord> replay_record(const DressedScene& dressed, const Sample& sample);

/// Writes `folder`/replay/pose_000123.h5, and makes the folder `replay` where it is not there.
void write_replay_of(const std::string& folder, const files::ReplayRecord& record);

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

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "cloth/types.h"
#include "files/certificate_group.h"

namespace toile::files {

inline constexpr int replay_version = 1;

/// What came of one try of a drape.
struct ReplayTry {
    std::string rung;    ///< what the try did differently
    std::string reason;  ///< of the status it ended with
    CertificateRecord certificate;
};

/// One pose that failed, with all that is needed to run it again: the data set is not.
struct ReplayRecord {
    std::string config;       ///< resolved TOML, paths absolute
    std::string config_hash;  ///< of the values and the files they name
    std::string program_version;
    int64_t id = 0;          ///< pose number
    std::string reason;      ///< why it failed
    std::string suite_case;  ///< case of the stability suite that it is; empty: a pose of a data set
    ClothMesh mesh;          ///< the garment as it was cut, with masses
    Positions pose;          ///< `[J x 3]`
    Positions start;         ///< `[V x 3]` where the cloth set out from: the neutral drape [m]
    Positions cloth;         ///< `[V x 3]` where it ended [m], in full precision
    CertificateRecord certificate;
    std::vector<ReplayTry> tries;
};

/// Writes DIR/replay/pose_000123.h5 or any other path, whole or not at all: attributes of the root `format` = "toile",
/// `kind` = "replay", `version`, `config`, `config_hash`, `program_version`, `id`, `reason`, and
/// `case` where it is one; `/replay/pose`, `start`
/// and `cloth`, float64; `/replay/rung` and `/replay/rung_reason` (T) string; `/certificate/*` (T + 1) as in a data
/// set, first that of the drape that was kept, then those of all tries. Times are left out, so the bytes depend on the
/// pose alone.
void write_replay(const std::string& path, const ReplayRecord& record);

/// Whether an HDF5 file of ours is a replay.
bool is_replay(const Hdf5File& file);

/// Throws Error for what keeps it from being one: no HDF5, another kind or version, missing datasets, shapes that do
/// not go together, values that are not finite where a drape sets out from.
ReplayRecord read_replay(const std::string& path);

}  // namespace toile::files

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "files/hdf5_file.h"

namespace toile::files {

inline constexpr int noise_version = 2;  ///< 1 did not hold the variants' cloth

/// One way in which samples were draped once more.
struct NoiseVariant {
    std::string name;  ///< names its datasets: "half_step"
    std::string what;  ///< what differs, one sentence
};

struct NoiseHeader {
    ClothMesh mesh;  ///< its rest position is the configured neutral drape
    std::vector<NoiseVariant> variant;
    std::vector<std::string> missing;  ///< variants that could not be had: "name: why"
    std::vector<std::string> reasons;  ///< index = status
    std::string config;                ///< resolved, TOML
    std::string config_hash;           ///< XXH3-128, hexadecimal
    std::string program_version;
    int64_t seed = 0;
    double share = 0;  ///< of the poses that was asked for
};

/// One pose, draped as configured and once for each variant of the header, in its order.
struct NoiseRecord {
    int64_t id = 0;
    int status = 0;   ///< of the configured drape
    Positions cloth;  ///< `[V x 3]` the configured drape [m]
    struct Variant {
        int status = 0;
        Positions cloth;           ///< `[V x 3]` [m]; stored as float32
        Eigen::VectorXd distance;  ///< `[V]` of each vertex from its place in the configured drape [m]
    };
    std::vector<Variant> variant;
    Eigen::VectorXd spread;                 ///< `[V]` [m]
    double spread_rms = 0, spread_max = 0;  ///< over the vertices [m]
};

/// Writes a noise file: under another name first, renamed by `finish`, so that a file of this name is whole. Chunked by
/// sample, with checksums.
///
/// `/mesh/...`, `/samples/id` (N), `/samples/cloth` (N,V,3), `/samples/status` (N) int8, for each variant
/// `/samples/<variant>_status` (N) int8, `/samples/<variant>_cloth` (N,V,3) float32 and `/samples/<variant>_distance`
/// (N,V), and `/samples/spread` (N,V), `/samples/spread_rms`, `/samples/spread_max` (N). Metres. Root attributes: those
/// of a data set, `share`, `reasons`, `variants`, `variant_meanings`, `missing_variants`.
class NoiseWriter {
  public:
    /// Throws Error where the file cannot be made.
    NoiseWriter(const std::string& path, const NoiseHeader& header, int64_t sample_count);
    ~NoiseWriter();  ///< without `finish`: leaves nothing behind
    NoiseWriter(const NoiseWriter&) = delete;
    NoiseWriter& operator=(const NoiseWriter&) = delete;

    /// Appends a sample. Throws Error if an array has the wrong size, or the disk is full.
    void write(const NoiseRecord& record);
    /// Error unless all samples were written.
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Throws Error unless `file` is a noise file of this version.
void check_noise_version(const Hdf5File& file, const std::string& path);

/// Reads a noise file; throws Error with "file:/dataset" for the first thing that keeps it from being read. A file of
/// another version is refused: it has to be measured anew.
class NoiseReader {
  public:
    explicit NoiseReader(const std::string& path);
    const NoiseHeader& header() const { return header_; }
    int64_t sample_count() const { return sample_count_; }
    NoiseRecord read(int64_t slot) const;

  private:
    Hdf5File file_;
    NoiseHeader header_;
    int64_t sample_count_ = 0;
};

}  // namespace toile::files

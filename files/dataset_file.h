#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "files/certificate_group.h"
#include "files/hdf5_file.h"

namespace toile::files {

inline constexpr int dataset_version = 1;

/// The body in its neutral pose, as the contract stores it.
struct DatasetBody {
    Triangles triangle;       ///< `[Fb x 3]`
    Positions rest_position;  ///< `[Vb x 3]` [m]
    std::vector<std::string> joint_name;
    std::vector<int> joint_parent;            ///< `[J]`
    std::vector<Eigen::Matrix4d> joint_bind;  ///< `[J]`
    std::vector<int> weight_vertex, weight_joint;
    std::vector<double> weight_value;  ///< `[W]` each
};

struct DatasetEmbedding {
    std::vector<int> triangle;  ///< `[V]`
    Positions barycentric;      ///< `[V x 3]`
};

struct DatasetImage {
    int size = 0;
    int layers = 0;
    Positions pattern_pixel;    ///< `[P x 3]` layer, column, row
    std::vector<uint8_t> mask;  ///< `[layers x size x size]`
};

/// What all samples share. What the scene does not have is absent here, in the file, and in every sample.
struct DatasetHeader {
    ClothMesh mesh;
    std::optional<DatasetBody> body;
    std::optional<DatasetEmbedding> embedding;
    std::optional<DatasetImage> image;
    std::string config;       ///< resolved, TOML
    std::string config_hash;  ///< XXH3-128, hexadecimal
    std::string program_version;
    int64_t seed = 0;
    std::vector<std::string> reasons;    ///< index = status
    std::map<std::string, double> gate;  ///< certificate dataset -> largest value of an accepted sample
    double duplicate_angle = 0;          ///< poses closer than this stay in one split [rad]
    /// Largest and root mean square error of mesh -> image -> mesh over the accepted samples [m]. The reader fills it
    /// in; the writer gathers it from the samples.
    std::optional<std::array<double, 2>> resampling_error;
};

/// A worker's share of a corpus: samples [first_slot, first_slot + sample count) of `corpus_samples`.
struct CorpusPart {
    int shard = 0, shards = 1;
    int64_t first_slot = 0;
    int64_t corpus_samples = 0;
};

/// One pose's data. A sample that failed (status not 0) is kept as it ended: its cloth may be at fault, or not finite,
/// and then so are displacement and image. Readers train on status 0.
struct SampleRecord {
    int64_t id = 0;
    int split = 0;  ///< 0 train, 1 validation, 2 test
    int status = 0;
    Positions pose;                         ///< `[J x 3]`; with a body
    Positions cloth;                        ///< `[V x 3]` r
    Positions embedded;                     ///< `[V x 3]` r̃; with an embedding
    Positions displacement;                 ///< `[V x 3]`; with an embedding
    std::vector<Eigen::Quaterniond> frame;  ///< `[V]`; with an embedding
    std::vector<float> image;               ///< `[C x H x W]`; with an image
    /// Largest and root mean square distance of the image, read back, to the displacement [m]; with an image.
    std::array<double, 2> resampling_error = {0, 0};
    CertificateRecord certificate;
};

using Digest = std::array<uint8_t, 16>;

/// Writes DIR/dataset.h5 or any other path (contract, "Dataset file"): under another name first, renamed by `finish`,
/// so that a file of this name is whole. Rows may come in any order and are stored in slot order, which keeps the bytes
/// the same whatever the number of workers; those that came early wait in memory. One thread at a time.
///
/// `/certificate/seconds` is measured and so differs from run to run: it lies in a file of its own, `timing_path`, and
/// the data set links to it. The data set's own bytes depend on the samples alone. A part of a corpus is joined with
/// others later: it holds its seconds itself, and the members of `CorpusPart` as root attributes.
///
/// Memory does not grow with the number of samples.
///
/// Beyond the contract: `/samples/digest` (N,16) uint8, see `sample_digest`; where there are images
/// `/samples/resampling_error` (N,2), largest and root mean square of each sample; `/certificate/moving_share` (N) and
/// `body_crossings`, `iterations`, `path_steps`, `tries` and `rung` (N) int32, and for each rung of the ladder k
/// `rung_k_status` (N) int32 and `rung_k_residual_force` (N), -1 where it was not tried, see simulate/certificate.h;
/// attributes `duplicate_angle` on /samples/split, the gate's bounds on /certificate under the names of its datasets;
/// `reasons` and `resampling_error` both at the root and on /samples/status and /samples/image.
class DatasetWriter {
  public:
    /// `deflate`: gzip level 0 to 9 of the samples' arrays. Throws Error where the file cannot be made.
    DatasetWriter(const std::string& path, const DatasetHeader& header, int sample_count, int deflate,
                  const std::optional<CorpusPart>& part = std::nullopt);
    ~DatasetWriter();  ///< without `finish`: leaves nothing behind
    DatasetWriter(const DatasetWriter&) = delete;
    DatasetWriter& operator=(const DatasetWriter&) = delete;

    /// Throws Error if the slot was written before, an array has the wrong size, or the disk is full.
    void write(int slot, SampleRecord sample);
    /// Error unless every slot was written.
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The file beside a data set that holds its `/certificate/seconds`: a/dataset.h5 -> a/dataset.timing.h5.
std::string timing_path(const std::string& dataset);

/// Reads a dataset file that `toile validate` would accept; throws Error for the first thing that keeps it from being
/// read. Where the timing file stayed behind, `seconds` is NaN.
class DatasetReader {
  public:
    explicit DatasetReader(const std::string& path);
    const DatasetHeader& header() const { return header_; }
    const std::optional<CorpusPart>& part() const { return part_; }
    int sample_count() const { return sample_count_; }
    SampleRecord read(int slot) const;
    Digest stored_digest(int slot) const;
    /// Samples [first, first + count): what is a value or a few for each, then the arrays of one.
    std::vector<SampleRecord> read_columns(int first, int count) const;
    std::vector<Digest> stored_digests(int first, int count) const;
    void read_arrays(int slot, SampleRecord& sample) const;
    const Hdf5File& file() const { return file_; }

  private:
    Hdf5File file_;
    DatasetHeader header_;
    std::optional<CorpusPart> part_;
    int sample_count_ = 0;
};

/// XXH3-128, big-endian, of a sample's stored bytes one after the other: id, split, status, pose, cloth, embedded,
/// displacement, frame, image, then residual_force, body_penetration, self_intersections, max_stretch, min_stretch and
/// max_speed, then moving_share, body_crossings, iterations, path_steps, tries and rung, then status and residual force
/// of each rung, each little-endian in its stored type; what the file lacks is left out, and so are `seconds`, which no
/// run repeats, and `resampling_error`, which follows from the rest.
Digest sample_digest(const SampleRecord& sample);

}  // namespace toile::files

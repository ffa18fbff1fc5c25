#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "files/hdf5_file.h"

namespace toile::files {

inline constexpr int projection_version = 1;

/// What the inextensibility prior was given, beside the target stiffness.
struct LimitTables {
    Edges edge;                       ///< `[E x 2]`
    Eigen::VectorXd edge_max_length;  ///< `[E]` [m]
};

/// What the quasistatic prior was given, beside the target stiffness.
struct SpringTables {
    Edges edge_spring;                                                       ///< `[E x 2]`
    Eigen::VectorXd edge_stiffness, edge_rest_length;                        ///< `[E]` [N/m], [m]
    Edges bending_spring;                                                    ///< `[B x 2]`
    Eigen::VectorXd bending_stiffness, bending_rest_length;                  ///< `[B]`
    Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor> axial_spring;     ///< `[A x 4]`
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> axial_weight;  ///< `[A x 2]`
    Eigen::VectorXd axial_stiffness;                                         ///< `[A]`
};

/// What all samples of a projection share. One of `limits` and `springs` is there: it tells which prior it was.
struct ProjectionHeader {
    ClothMesh mesh;  ///< pattern and mass may be empty
    std::optional<LimitTables> limits;
    std::optional<SpringTables> springs;
    Eigen::VectorXd target_stiffness;  ///< `[V]`
    bool gradient = false;             ///< derivatives are there
    double tolerance = 0;              ///< residual that status 0 promises
    std::string config;                ///< resolved options, TOML
    std::string config_hash;           ///< XXH3-128, hexadecimal
    std::string program_version;

    const char* prior() const { return limits ? "inextensibility" : "quasistatic"; }
    int64_t edge_count() const { return limits ? limits->edge.rows() : springs->edge_spring.rows(); }
};

/// Consecutive samples of a projection, `n` of them. What the header does not announce is empty.
struct ProjectionRows {
    std::span<const double> predicted, projected;                   ///< `[n x V x 3]`
    std::vector<int8_t> status;                                     ///< `[n]`
    std::vector<int32_t> iterations;                                ///< `[n]`
    std::vector<double> seconds, residual;                          ///< `[n]`
    std::span<const double> multiplier;                             ///< `[n x E]`; inextensibility
    std::vector<double> loss, gradient_seconds, gradient_residual;  ///< `[n]`; gradient
    std::span<const double> gradient;                               ///< `[n x V x 3]`; gradient
    std::vector<int32_t> weakly_active;                             ///< `[n]`; gradient, inextensibility
    std::vector<double> active_set_distance;                        ///< `[n]`; gradient, inextensibility
    std::span<const double> gradient_mu, gradient_mu_vertex;        ///< `[n]`, `[n x V]`; gradient, quasistatic
};

/// Writes a projection file (contract, "Projection file"), a few samples at a time: under another name first, renamed
/// by `finish`, so that a file of this name is whole. Chunked by sample, with checksums, not compressed.
///
/// Beyond the contract, so that a file can be checked by itself: `/samples/predicted`, `/samples/gradient_residual`
/// (of the linear system behind the gradient), `/samples/active_set_distance`,
/// and the root attributes of data sets with `prior` and `tolerance`.
class ProjectionWriter {
  public:
    /// Throws Error where the file cannot be made.
    ProjectionWriter(const std::string& path, const ProjectionHeader& header, int64_t sample_count);
    ~ProjectionWriter();  ///< without `finish`: leaves nothing behind
    ProjectionWriter(const ProjectionWriter&) = delete;
    ProjectionWriter& operator=(const ProjectionWriter&) = delete;

    /// Appends samples. Throws Error if an array has the wrong size, or the disk is full.
    void write(const ProjectionRows& rows);
    /// Error unless all samples were written.
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// What a projection file holds of consecutive samples.
struct StoredProjection {
    std::vector<double> predicted, projected, multiplier, loss, gradient;
    std::vector<double> seconds, residual;
    std::vector<int8_t> status;
};

/// Reads a projection file; throws Error with "file:/dataset" for the first thing that keeps it from being read.
class ProjectionReader {
  public:
    explicit ProjectionReader(const std::string& path);
    const ProjectionHeader& header() const { return header_; }
    int64_t sample_count() const { return sample_count_; }
    StoredProjection read(int64_t first, int64_t count) const;

  private:
    Hdf5File file_;
    ProjectionHeader header_;
    int64_t sample_count_ = 0;
};

}  // namespace toile::files

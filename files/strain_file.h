#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::files {

inline constexpr int strain_version = 1;

/// Strain of one frame, of all triangles or of all vertices (n of them), row-major. An empty array is not stored.
struct StrainColumns {
    std::vector<std::int8_t> fault;       ///< n
    std::vector<double> stretch;          ///< n x 2, of vertices n x 3
    std::vector<double> surface_stretch;  ///< n x 2; vertices alone
    std::vector<double> gradient;         ///< n x 3 x 2, of vertices n x 3 x 3
    std::vector<double> rotation;         ///< n x 3 x 2, of vertices n x 4
    std::vector<double> rest_direction;   ///< n x 2 x 3, of vertices n x 3 x 3
    std::vector<double> direction;        ///< likewise
    std::vector<double> residual;         ///< n; vertices alone
};

/// Rates of one frame, likewise.
struct RateColumns {
    std::vector<double> velocity_gradient;  ///< n x 3 x 3
    std::vector<double> strain_rate;        ///< n x 2
    std::vector<double> spin;               ///< n x 3
    std::vector<double> rate_error;         ///< n
};

struct StrainHeader {
    ClothMesh mesh;
    std::vector<double> triangle_axis;  ///< F x 2 x 3: the frames of the rest triangles that F is written in
    std::string source, rest;           ///< what was measured, and from what
    std::string neighbourhood;          ///< "ring:1"
    double normal_weight = 1;
    double time_step = 0;             ///< [s]; 0: frames have no time between them
    std::vector<std::string> faults;  ///< index = fault
    std::string program_version;
};

/// Writes a strain file: under another name first, renamed by `finish`, so that a file of this name is whole. Each
/// frame is a chunk of its own, with checksums; the bytes depend on the frames alone. N frames, F triangles, V
/// vertices.
///
/// | dataset | shape | meaning |
/// |---|---|---|
/// | `/mesh/...` | | as in every file; strain is measured from its pattern, where there is one |
/// | `/mesh/triangle_axis` | (F,2,3) | the rest triangle's orthonormal frame, at rest: of a pattern (u, v, 0) |
/// | `/frames/name` | (N) string | the file of each frame, or "sample 12" |
/// | `/triangle/fault` | (N,F) int8 | 0, or an index into the attribute `faults`; values that are not there are NaN |
/// | `/triangle/stretch` | (N,F,2) | principal stretches, the larger first |
/// | `/triangle/gradient` | (N,F,3,2) | F, from the rest triangle's frame to space; U = rotation^T F |
/// | `/triangle/rotation` | (N,F,3,2) | R of F = R U |
/// | `/triangle/rest_direction`, `direction` | (N,F,2,3) | of each principal stretch, unit, at rest and in space |
/// | `/vertex/fault` | (N,V) int8 | as above |
/// | `/vertex/stretch` | (N,V,3) | principal stretches of the neighbourhood's F, the largest first |
/// | `/vertex/surface_stretch` | (N,V,2) | those within the tangent plane at rest |
/// | `/vertex/gradient` | (N,V,3,3) | F |
/// | `/vertex/rotation` | (N,V,4) | Kabsch's, unit quaternion (w,x,y,z) |
/// | `/vertex/rest_direction`, `direction` | (N,V,3,3) | row k belongs to stretch k |
/// | `/vertex/residual` | (N,V) | root mean square of what F misses over that of the neighbourhood |
///
/// With a time step, for triangles and vertices alike:
///
/// | `velocity_gradient` | (N,n,3,3) | L = dF/dt F^-1 [1/s]; D and W are its symmetric and skew parts |
/// | `strain_rate` | (N,n,2) | principal values of D in the tangent plane [1/s] |
/// | `spin` | (N,n,3) | w of W x = w cross x [rad/s] |
/// | `rate_error` | (N,n) | the time step's error of L (Frobenius norm) [1/s]; NaN without an estimate |
///
/// Where stretches alone are asked for, `gradient`, `rotation`, the directions and `velocity_gradient` are left out.
///
/// Root attributes: `format`, `version`, `kind` = "strain", `program_version`, `source`, `rest`, `neighbourhood`,
/// `normal_weight`, `faults`, and `time_step` [s] where there is one.
class StrainWriter {
  public:
    /// Throws Error where the file cannot be made.
    StrainWriter(const std::string& path, const StrainHeader& header, std::int64_t frame_count);
    ~StrainWriter();  ///< without `finish`: leaves nothing behind
    StrainWriter(const StrainWriter&) = delete;
    StrainWriter& operator=(const StrainWriter&) = delete;

    /// Throws Error where an array has the wrong size, or the disk is full.
    void write(std::int64_t frame, const StrainColumns& triangles, const StrainColumns& vertices);
    void write_rates(std::int64_t frame, const RateColumns& triangles, const RateColumns& vertices);
    void finish(const std::vector<std::string>& frame_name);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files

#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "cloth/types.h"
#include "skin/surface_extraction.h"

namespace toile::skin {

/// A narrow-band signed distance field on a sparse grid (OpenVDB), negative inside. Immutable once built; `sample` may
/// be called from several threads, each with its own `Sampler`.
class LevelSet {
  public:
    /// From a closed surface (an open one has no inside). At the grid's points distances are those to the triangles, up
    /// to a twentieth of a voxel within two voxels of the surface and a third of one beyond; farther than `band_width`
    /// [m, at least two voxels] they are clamped. Self-overlapping surfaces give the union of their insides. Works on
    /// the calling thread alone; the result depends on the arguments alone. Throws Error for a surface without
    /// triangles, with indices out of range or positions that are not finite, and for a voxel or band out of range.
    LevelSet(const Triangles& triangle, const Positions& position, double voxel, double band_width);
    /// The union of closed surfaces, each a run of triangles that ends before a row of `part_end`. Distances within the
    /// union are those of the part that a point lies deepest in. Gaps between two parts stay open however narrow, while
    /// those within one close where they are narrower than about two voxels.
    LevelSet(const Triangles& triangle, const std::vector<int>& part_end, const Positions& position, double voxel,
             double band_width);
    ~LevelSet();
    LevelSet(LevelSet&&) noexcept;
    LevelSet& operator=(LevelSet&&) noexcept;

    double voxel() const;       ///< [m]
    double band_width() const;  ///< [m]

    struct Sample {
        double distance;           ///< signed distance [m], clamped to +-band_width
        Eigen::Vector3d gradient;  ///< gradient of the trilinear interpolant; zero outside the band
        int triangle;              ///< a nearest triangle (of the nearest voxel), -1 outside the band
    };
    /// A cursor with its own cache: make one a thread.
    class Sampler {
      public:
        explicit Sampler(const LevelSet& level_set);
        ~Sampler();
        Sample operator()(const Eigen::Vector3d& point) const;
        double distance(const Eigen::Vector3d& point) const;  ///< the distance alone

        struct Smooth {
            double distance;           ///< [m]
            Eigen::Vector3d gradient;  ///< continuous in the point
        };
        /// The grid smoothed by quadratic B-splines: once continuously differentiable, as a minimiser wants it. Lies
        /// above the distance by about voxel²/8 times the sum of the principal curvatures on a convex surface.
        Smooth smooth(const Eigen::Vector3d& point) const;
        double smooth_distance(const Eigen::Vector3d& point) const;  ///< the distance of `smooth` alone
        /// Second derivatives of `smooth`'s distance [1/m]: constant along each axis within a voxel.
        Eigen::Matrix3d smooth_curvature(const Eigen::Vector3d& point) const;

      private:
        struct Impl;
        std::unique_ptr<Impl> impl_;
    };

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::skin

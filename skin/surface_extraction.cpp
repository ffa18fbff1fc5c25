#include "skin/surface_extraction.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "cloth/error.h"

namespace toile::skin {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

/// Whole voxels of the box, and how to fill them.
class BoxSampler {
  public:
    BoxSampler(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& lower,
               const Eigen::Vector3d& upper, double voxel)
        : distance_(distance),
          voxel_(voxel),
          first_((lower / voxel).array().floor().cast<int>()),
          last_((upper / voxel).array().ceil().cast<int>()),
          // What is far only has to have the right sign; beyond the box all is outside.
          grid_(FloatGrid::create(static_cast<float>(4.0 * voxel))),
          cursor_(grid_->getAccessor()) {
        grid_->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    }

    FloatGrid::Ptr fill() {
        for (int i = first_[0]; i <= last_[0]; i += block)
            for (int j = first_[1]; j <= last_[1]; j += block)
                for (int k = first_[2]; k <= last_[2]; k += block) fill_block({i, j, k});
        return grid_;
    }

  private:
    static constexpr int block = 4;

    double value_at(const Eigen::Vector3d& voxel) const {
        const double value = distance_(voxel * voxel_);
        if (!std::isfinite(value)) throw Error("extract_surface: the distance is not finite");
        return value;
    }
    void fill_block(const Eigen::Vector3i& corner) {
        const Eigen::Vector3i end = (corner.array() + (block - 1)).min(last_.array());
        const Eigen::Vector3d center = 0.5 * (corner + end).cast<double>();
        const double half_diagonal = 0.5 * (end - corner).cast<double>().norm() * voxel_;
        if (value_at(center) > 2.0 * half_diagonal + voxel_) return;
        for (int i = corner[0]; i <= end[0]; ++i)
            for (int j = corner[1]; j <= end[1]; ++j)
                for (int k = corner[2]; k <= end[2]; ++k) fill_voxel({i, j, k});
    }
    void fill_voxel(const Eigen::Vector3i& at) {
        const double value = value_at(at.cast<double>());
        const bool on_box = (at.array() == first_.array()).any() || (at.array() == last_.array()).any();
        if (on_box && value < 0.0) throw Error("extract_surface: the surface leaves the box");
        cursor_.setValue(Coord(at[0], at[1], at[2]), static_cast<float>(value));
    }

    const std::function<double(const Eigen::Vector3d&)>& distance_;
    double voxel_;
    Eigen::Vector3i first_, last_;
    FloatGrid::Ptr grid_;
    FloatGrid::Accessor cursor_;
};

Surface to_surface(const std::vector<openvdb::Vec3s>& point, const std::vector<openvdb::Vec4I>& quad) {
    Surface surface;
    surface.position.resize(static_cast<Eigen::Index>(point.size()), 3);
    for (size_t v = 0; v < point.size(); ++v)
        surface.position.row(static_cast<Eigen::Index>(v)) << point[v][0], point[v][1], point[v][2];
    surface.triangle.resize(2 * static_cast<Eigen::Index>(quad.size()), 3);
    for (size_t q = 0; q < quad.size(); ++q) {
        const std::array<int, 4> c = {static_cast<int>(quad[q][0]), static_cast<int>(quad[q][1]),
                                      static_cast<int>(quad[q][2]), static_cast<int>(quad[q][3])};
        const auto at = [&](int k) { return surface.position.row(c[k]); };
        const int s = (at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm() ? 0 : 1;
        const auto f = 2 * static_cast<Eigen::Index>(q);
        surface.triangle.row(f) << c[s], c[s + 1], c[s + 2];
        surface.triangle.row(f + 1) << c[s], c[s + 2], c[(s + 3) % 4];
    }
    return surface;
}

}  // namespace

Surface extract_surface(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& lower,
                        const Eigen::Vector3d& upper, double voxel) {
    if (!(voxel > 0.0) || !std::isfinite(voxel))
        throw Error("extract_surface: voxel is " + std::to_string(voxel) + " m, must be above 0");
    if (!lower.allFinite() || !upper.allFinite() || !(lower.array() < upper.array()).all())
        throw Error("extract_surface: the box is empty");
    if (((upper - lower) / voxel).prod() > 1e9) throw Error("extract_surface: the box holds too many voxels");
    const FloatGrid::Ptr grid = BoxSampler(distance, lower, upper, voxel).fill();
    std::vector<openvdb::Vec3s> point;
    std::vector<openvdb::Vec4I> quad;
    // OpenVDB splits its work by the number of threads it sees: show it ours alone.
    tbb::task_arena arena(1);
    arena.execute([&] { openvdb::tools::volumeToMesh(*grid, point, quad); });
    return to_surface(point, quad);
}

}  // namespace toile::skin

#include "skin/level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "cloth/error.h"

namespace toile::skin {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Int32Grid;
using Leaf = FloatGrid::TreeType::LeafNodeType;
// Neither tree changes once built, so the accessors need not register with them (a lock for each cursor).
using FloatCursor = openvdb::tree::ValueAccessor<const FloatGrid::TreeType, false>;
using Int32Cursor = openvdb::tree::ValueAccessor<const Int32Grid::TreeType, false>;

// Voxel indices are 32-bit; this many to either side of the origin leaves room for the band.
constexpr double largest_index = 1e8;

/// OpenVDB splits its work by the number of threads it sees, and callers run one drape a thread: keep it to ours.
template <typename Work>
void run_on_this_thread(const Work& work) {
    tbb::task_arena arena(1);
    arena.execute(work);
}

/// What openvdb::tools::meshToVolume reads a mesh through: positions in units of voxels.
class MeshInVoxels {
  public:
    MeshInVoxels(const Triangles& triangle, const Positions& position, double voxel)
        : triangle_(triangle), position_(position / voxel) {}

    size_t polygonCount() const { return static_cast<size_t>(triangle_.rows()); }
    size_t pointCount() const { return static_cast<size_t>(position_.rows()); }
    size_t vertexCount(size_t) const { return 3; }
    void getIndexSpacePoint(size_t polygon, size_t corner, openvdb::Vec3d& point) const {
        const auto row = position_.row(triangle_(static_cast<int>(polygon), static_cast<int>(corner)));
        point = openvdb::Vec3d(row[0], row[1], row[2]);
    }

  private:
    const Triangles& triangle_;
    Positions position_;
};

void check_level_set_input(const Triangles& triangle, const Positions& position, double voxel, double band_width) {
    if (!(voxel > 0.0) || !std::isfinite(voxel))
        throw Error("level set: voxel is " + std::to_string(voxel) + " m, must be above 0");
    if (!(band_width >= 2.0 * voxel) || !std::isfinite(band_width))
        throw Error("level set: band_width is " + std::to_string(band_width) + " m, must be at least two voxels (" +
                    std::to_string(2.0 * voxel) + " m)");
    if (triangle.rows() == 0) throw Error("level set: the surface has no triangles");
    for (Eigen::Index v = 0; v < position.rows(); ++v)
        if (!position.row(v).allFinite())
            throw Error("level set: vertex " + std::to_string(v) + " of the surface is not finite");
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= position.rows())
        throw Error("level set: a triangle of the surface names a vertex that does not exist");
    if (position.cwiseAbs().maxCoeff() / voxel > largest_index)
        throw Error("level set: the surface spans too many voxels of " + std::to_string(voxel) + " m");
}

/// The corner of the cell a point lies in, and where in it, each in [0, 1).
struct Cell {
    Coord corner;
    Eigen::Vector3d fraction;

    explicit Cell(const Eigen::Vector3d& index) {
        const Eigen::Vector3d floor = index.array().floor();
        corner = Coord(static_cast<int>(floor[0]), static_cast<int>(floor[1]), static_cast<int>(floor[2]));
        fraction = index - floor;
    }
    Coord nearest() const {
        return corner.offsetBy(fraction[0] > 0.5 ? 1 : 0, fraction[1] > 0.5 ? 1 : 0, fraction[2] > 0.5 ? 1 : 0);
    }
};

/// Corner values in the order of bits x, y, z: corner k is offset by (k & 4, k & 2, k & 1) != 0.
std::array<double, 8> corner_values(FloatCursor& cursor, const Coord& corner) {
    constexpr int last = Leaf::DIM - 1;
    const int x = corner[0] & last, y = corner[1] & last, z = corner[2] & last;
    std::array<double, 8> value;
    if (x < last && y < last && z < last) {  // all eight in one leaf: two cells in three
        if (const Leaf* leaf = cursor.probeConstLeaf(corner)) {
            const float* data = leaf->buffer().data() + Leaf::coordToOffset(corner);
            constexpr int dx = Leaf::DIM * Leaf::DIM, dy = Leaf::DIM;
            for (int k = 0; k < 8; ++k) value[k] = data[(k >> 2) * dx + ((k >> 1) & 1) * dy + (k & 1)];
        } else {
            value.fill(cursor.getValue(corner));
        }
        return value;
    }
    for (int k = 0; k < 8; ++k) value[k] = cursor.getValue(corner.offsetBy(k >> 2, (k >> 1) & 1, k & 1));
    return value;
}

/// Quadratic B-spline around the voxel nearest to a point: three weights an axis and their derivatives.
struct Spline {
    Coord centre;
    std::array<Eigen::Vector3d, 3> weight, slope;  // [axis][-1, 0, +1]

    explicit Spline(const Eigen::Vector3d& index) {
        for (int axis = 0; axis < 3; ++axis) {
            const double nearest = std::floor(index[axis] + 0.5), f = index[axis] - nearest;
            centre[axis] = static_cast<int>(nearest);
            weight[axis] << 0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f);
            slope[axis] << f - 0.5, -2.0 * f, f + 0.5;
        }
    }
};

/// The 27 values around a voxel, x slowest.
std::array<double, 27> spline_values(FloatCursor& cursor, const Coord& centre) {
    constexpr int last = Leaf::DIM - 1;
    std::array<double, 27> value;
    const auto inside = [](int index) { return (index & last) > 0 && (index & last) < last; };
    if (inside(centre[0]) && inside(centre[1]) && inside(centre[2])) {
        if (const Leaf* leaf = cursor.probeConstLeaf(centre)) {
            const float* data = leaf->buffer().data() + Leaf::coordToOffset(centre);
            constexpr int dx = Leaf::DIM * Leaf::DIM, dy = Leaf::DIM;
            for (int k = 0; k < 27; ++k) value[k] = data[(k / 9 - 1) * dx + (k / 3 % 3 - 1) * dy + k % 3 - 1];
        } else {
            value.fill(cursor.getValue(centre));
        }
        return value;
    }
    for (int k = 0; k < 27; ++k) value[k] = cursor.getValue(centre.offsetBy(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
    return value;
}

double interpolate(const std::array<double, 8>& value, const Eigen::Vector3d& t) {
    const auto mix = [](double a, double b, double s) { return a + s * (b - a); };
    const double x0 = mix(mix(value[0], value[1], t[2]), mix(value[2], value[3], t[2]), t[1]);
    const double x1 = mix(mix(value[4], value[5], t[2]), mix(value[6], value[7], t[2]), t[1]);
    return mix(x0, x1, t[0]);
}

/// Derivative of `interpolate` by t.
Eigen::Vector3d interpolant_gradient(const std::array<double, 8>& value, const Eigen::Vector3d& t) {
    const auto mix = [](double a, double b, double s) { return a + s * (b - a); };
    const double x0y0 = mix(value[0], value[1], t[2]), x0y1 = mix(value[2], value[3], t[2]);
    const double x1y0 = mix(value[4], value[5], t[2]), x1y1 = mix(value[6], value[7], t[2]);
    const double dz0 = mix(value[1] - value[0], value[3] - value[2], t[1]);
    const double dz1 = mix(value[5] - value[4], value[7] - value[6], t[1]);
    return {mix(x1y0, x1y1, t[1]) - mix(x0y0, x0y1, t[1]), mix(x0y1 - x0y0, x1y1 - x1y0, t[0]), mix(dz0, dz1, t[0])};
}

}  // namespace

struct LevelSet::Impl {
    double voxel;
    double band_width;
    FloatGrid::Ptr distance;
    Int32Grid::Ptr nearest_triangle;
    Eigen::Vector3d lower, upper;  // of the band, in voxels

    void convert(const Triangles& triangle, const Positions& position) {
        const MeshInVoxels mesh(triangle, position, voxel);
        const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
        const auto width = static_cast<float>(band_width / voxel);
        nearest_triangle = Int32Grid::create(-1);
        // With renormalisation, which is the default: it costs up to a twentieth of a voxel along creases, and without
        // it voxels where the surface overlaps itself come out with the wrong sign.
        distance = openvdb::tools::meshToVolume<FloatGrid>(mesh, *transform, width, width, 0, nearest_triangle.get());
    }
    /// Joins a part whose triangles are numbered from `first`. The lesser distance is the union's.
    void unite(Impl& part, int first) {
        FloatGrid::Accessor mine = distance->getAccessor();
        Int32Grid::Accessor my_triangle = nearest_triangle->getAccessor(), other = part.nearest_triangle->getAccessor();
        for (auto voxel_in = part.distance->cbeginValueOn(); voxel_in; ++voxel_in) {
            if (!voxel_in.isVoxelValue() || !(*voxel_in < mine.getValue(voxel_in.getCoord()))) continue;
            const int triangle = other.getValue(voxel_in.getCoord());
            if (triangle >= 0) my_triangle.setValue(voxel_in.getCoord(), first + triangle);
        }
        openvdb::tools::csgUnion(*distance, *part.distance);
    }
    /// OpenVDB trims narrow bands only; without this, values just beyond a wide one would exceed it.
    void clamp_to_band() {
        const float limit = distance->background();
        for (auto leaf = distance->tree().beginLeaf(); leaf; ++leaf) {
            float* data = leaf->buffer().data();
            for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) data[i] = std::clamp(data[i], -limit, limit);
        }
    }
    void find_bounds() {
        openvdb::CoordBBox box;
        distance->tree().evalLeafBoundingBox(box);
        const Coord low = box.min(), high = box.max();
        lower = Eigen::Vector3d(low[0], low[1], low[2]).array() - 1.0;
        upper = Eigen::Vector3d(high[0], high[1], high[2]).array() + 1.0;
    }
};

LevelSet::LevelSet(const Triangles& triangle, const Positions& position, double voxel, double band_width)
    : impl_(std::make_unique<Impl>()) {
    check_level_set_input(triangle, position, voxel, band_width);
    impl_->voxel = voxel;
    impl_->band_width = band_width;
    run_on_this_thread([&] { impl_->convert(triangle, position); });
    impl_->clamp_to_band();
    impl_->find_bounds();
}

LevelSet::LevelSet(const Triangles& triangle, const std::vector<int>& part_end, const Positions& position, double voxel,
                   double band_width)
    : impl_(std::make_unique<Impl>()) {
    check_level_set_input(triangle, position, voxel, band_width);
    impl_->voxel = voxel;
    impl_->band_width = band_width;
    run_on_this_thread([&] {
        int first = 0;
        for (const int end : part_end) {
            Impl part{voxel, band_width, {}, {}, {}, {}};
            part.convert(triangle.middleRows(first, end - first), position);
            if (impl_->distance) {
                impl_->unite(part, first);
            } else {
                impl_->distance = part.distance;
                impl_->nearest_triangle = part.nearest_triangle;
            }
            first = end;
        }
    });
    impl_->clamp_to_band();
    impl_->find_bounds();
}

LevelSet::~LevelSet() = default;
LevelSet::LevelSet(LevelSet&&) noexcept = default;
LevelSet& LevelSet::operator=(LevelSet&&) noexcept = default;

double LevelSet::voxel() const {
    return impl_->voxel;
}
double LevelSet::band_width() const {
    return impl_->band_width;
}

struct LevelSet::Sampler::Impl {
    const LevelSet::Impl* level_set;
    double per_voxel;   // 1 / voxel
    double background;  // the grid's single-precision band width
    mutable FloatCursor distance;
    mutable Int32Cursor nearest_triangle;

    explicit Impl(const LevelSet::Impl& from)
        : level_set(&from),
          per_voxel(1.0 / from.voxel),
          background(from.distance->background()),
          distance(from.distance->tree()),
          nearest_triangle(from.nearest_triangle->tree()) {}

    /// False as well for a point that is not finite.
    bool within_bounds(const Eigen::Vector3d& index) const {
        return (index.array() > level_set->lower.array()).all() && (index.array() < level_set->upper.array()).all();
    }
    double within_band(double value) const {
        if (value >= background) return level_set->band_width;
        return value <= -background ? -level_set->band_width : value;
    }
    /// At the band's rim the nearest voxel may lie outside; any corner that lies in it will do.
    int triangle_near(const Cell& cell) const {
        int triangle = nearest_triangle.getValue(cell.nearest());
        for (int k = 0; k < 8 && triangle < 0; ++k)
            triangle = nearest_triangle.getValue(cell.corner.offsetBy(k >> 2, (k >> 1) & 1, k & 1));
        return triangle;
    }
};

LevelSet::Sampler::Sampler(const LevelSet& level_set) : impl_(std::make_unique<Impl>(*level_set.impl_)) {}
LevelSet::Sampler::~Sampler() = default;

LevelSet::Sample LevelSet::Sampler::operator()(const Eigen::Vector3d& point) const {
    const double band_width = impl_->level_set->band_width;
    const Sample outside{band_width, Eigen::Vector3d::Zero(), -1};
    const Eigen::Vector3d index = point * impl_->per_voxel;
    if (!impl_->within_bounds(index)) return outside;
    const Cell cell(index);
    const std::array<double, 8> value = corner_values(impl_->distance, cell.corner);
    const auto [least, most] = std::minmax_element(value.begin(), value.end());
    if (*least >= impl_->background) return outside;
    if (*most <= -impl_->background) return {-band_width, Eigen::Vector3d::Zero(), -1};
    return {impl_->within_band(interpolate(value, cell.fraction)),
            interpolant_gradient(value, cell.fraction) * impl_->per_voxel, impl_->triangle_near(cell)};
}

double LevelSet::Sampler::distance(const Eigen::Vector3d& point) const {
    const double band_width = impl_->level_set->band_width;
    const Eigen::Vector3d index = point * impl_->per_voxel;
    if (!impl_->within_bounds(index)) return band_width;
    const Cell cell(index);
    return impl_->within_band(interpolate(corner_values(impl_->distance, cell.corner), cell.fraction));
}

LevelSet::Sampler::Smooth LevelSet::Sampler::smooth(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d index = point * impl_->per_voxel;
    if (!impl_->within_bounds(index)) return {impl_->level_set->band_width, Eigen::Vector3d::Zero()};
    const Spline spline(index);
    const std::array<double, 27> value = spline_values(impl_->distance, spline.centre);
    Smooth smooth{0.0, Eigen::Vector3d::Zero()};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const Eigen::Map<const Eigen::Vector3d> row(value.data() + 9 * i + 3 * j);
            const double along = row.dot(spline.weight[2]), wx = spline.weight[0][i], wy = spline.weight[1][j];
            smooth.distance += wx * wy * along;
            smooth.gradient += Eigen::Vector3d(spline.slope[0][i] * wy * along, wx * spline.slope[1][j] * along,
                                               wx * wy * row.dot(spline.slope[2]));
        }
    }
    smooth.gradient *= impl_->per_voxel;
    return smooth;
}

double LevelSet::Sampler::smooth_distance(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d index = point * impl_->per_voxel;
    if (!impl_->within_bounds(index)) return impl_->level_set->band_width;
    const Spline spline(index);
    const std::array<double, 27> value = spline_values(impl_->distance, spline.centre);
    double distance = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            distance += spline.weight[0][i] * spline.weight[1][j] *
                        Eigen::Map<const Eigen::Vector3d>(value.data() + 9 * i + 3 * j).dot(spline.weight[2]);
    return distance;
}

Eigen::Matrix3d LevelSet::Sampler::smooth_curvature(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d index = point * impl_->per_voxel;
    if (!impl_->within_bounds(index)) return Eigen::Matrix3d::Zero();
    const Spline spline(index);
    const std::array<double, 27> value = spline_values(impl_->distance, spline.centre);
    const Eigen::Vector3d bend(1.0, -2.0, 1.0);  // second derivatives of the three weights
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const Eigen::Map<const Eigen::Vector3d> row(value.data() + 9 * i + 3 * j);
            const double along = row.dot(spline.weight[2]), rise = row.dot(spline.slope[2]);
            const double wx = spline.weight[0][i], wy = spline.weight[1][j];
            const double sx = spline.slope[0][i], sy = spline.slope[1][j];
            curvature(0, 0) += bend[i] * wy * along;
            curvature(1, 1) += wx * bend[j] * along;
            curvature(2, 2) += wx * wy * row.dot(bend);
            curvature(1, 0) += sx * sy * along;
            curvature(2, 0) += sx * wy * rise;
            curvature(2, 1) += wx * sy * rise;
        }
    }
    curvature = curvature.selfadjointView<Eigen::Lower>();
    return curvature * (impl_->per_voxel * impl_->per_voxel);
}

}  // namespace toile::skin

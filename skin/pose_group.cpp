#include "skin/pose_group.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace toile::skin {
namespace {

constexpr int grid_size = 6;    // coordinates that make up a cell
constexpr int sieve_size = 12;  // coordinates compared before poses are
constexpr int reference_count = 3;
constexpr int trial_count = 128;  // poses that tell which coordinates vary most

using Coordinates = std::array<float, sieve_size>;
using Cell = std::array<std::int64_t, grid_size>;

Eigen::Quaterniond rotation(const Pose& pose, Eigen::Index joint) {
    const Eigen::Vector3d turn = pose.row(joint).transpose();
    const double angle = turn.norm();
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX()));
}

/// The columns that vary most, each beyond what those before it tell already (a limb that copies another tells
/// nothing).
std::vector<Eigen::Index> most_telling(Eigen::MatrixXd value) {
    value.rowwise() -= value.colwise().mean().eval();
    std::vector<Eigen::Index> column;
    Eigen::Index next = 0;
    while (column.size() < sieve_size && value.colwise().squaredNorm().maxCoeff(&next) > 1e-12) {
        column.push_back(next);
        const Eigen::VectorXd direction = value.col(next).normalized();
        value -= direction * (direction.transpose() * value).eval();
        value.col(next).setZero();
    }
    return column;
}

/// Coordinates of a pose: angles of some joints to those of reference poses. None differs between two poses by more
/// than their largest joint rotation (the triangle inequality), so poses far apart here are far apart.
class CoordinateChart {
  public:
    CoordinateChart(const PoseGroups::Source& pose, std::int64_t count) {
        const std::int64_t trials = std::min<std::int64_t>(count, trial_count);
        std::vector<Pose> trial;
        // Spread over the whole sequence: the first poses of a motion may stand still.
        for (std::int64_t i = 0; i < trials; ++i) trial.push_back(pose(i * count / trials));
        if (trial.empty()) return;
        std::vector<Pose> reference;
        for (std::size_t r = 0; r < reference_count; ++r)
            reference.push_back(trial[r * trial.size() / reference_count]);
        std::vector<Axis> axis;
        for (Eigen::Index joint = 0; joint < trial.front().rows(); ++joint)
            for (const Pose& pose_of : reference) axis.push_back({joint, rotation(pose_of, joint).conjugate()});
        Eigen::MatrixXd value(trials, axis.size());
        for (std::size_t i = 0; i < axis.size(); ++i)
            for (std::int64_t k = 0; k < trials; ++k) value(k, i) = angle(axis[i], trial[k]);
        for (const Eigen::Index i : most_telling(value)) axis_.push_back(axis[i]);
    }

    Coordinates of(const Pose& pose) const {
        Coordinates coordinates{};
        for (std::size_t i = 0; i < axis_.size(); ++i) coordinates[i] = static_cast<float>(angle(axis_[i], pose));
        return coordinates;
    }

  private:
    struct Axis {
        Eigen::Index joint;
        Eigen::Quaterniond from;  ///< undoes the reference's rotation
    };
    static double angle(const Axis& axis, const Pose& pose) {
        const Eigen::Quaterniond turn = axis.from * rotation(pose, axis.joint);
        return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
    }
    std::vector<Axis> axis_;
};

struct Kept {
    Coordinates at;
    std::int64_t number;
    std::int64_t group;
    std::int32_t next;  ///< in the same bucket, -1: none
};

}  // namespace

struct PoseGroups::Impl {
    Impl(Source source, std::int64_t poses, double duplicate_angle)
        : pose(std::move(source)), angle(duplicate_angle), chart(pose, angle > 0 ? poses : 0) {
        if (!(angle > 0)) return;
        std::size_t buckets = 1;
        while (static_cast<std::int64_t>(buckets) < poses) buckets *= 2;
        bucket.assign(buckets, -1);
    }

    std::int64_t index(double coordinate) const {
        return static_cast<std::int64_t>(std::floor(coordinate / (4 * std::max(angle, 1e-6))));
    }
    /// Cells that share a bucket are only searched needlessly.
    std::size_t bucket_of(const Cell& cell) const {
        std::uint64_t hash = 0;
        for (const std::int64_t c : cell) {
            hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash & (bucket.size() - 1);
    }
    void keep(const Coordinates& at, std::int64_t number, std::int64_t group) {
        Cell cell;
        for (int i = 0; i < grid_size; ++i) cell[i] = index(at[i]);
        std::int32_t& head = bucket[bucket_of(cell)];
        kept.push_back({at, number, group, head});
        head = static_cast<std::int32_t>(kept.size()) - 1;
    }

    bool within(const Coordinates& a, const Coordinates& b, double reach) const {
        for (int i = 0; i < sieve_size; ++i)
            if (std::abs(a[i] - b[i]) > reach) return false;
        return true;
    }

    /// The kept poses whose coordinates are within `angle`.
    void find_candidates(const Coordinates& at) {
        candidate.clear();
        const double reach = angle + 1e-5;  // more than the rounding of the coordinates
        Cell low, high, cell;
        for (int i = 0; i < grid_size; ++i) {
            cell[i] = low[i] = index(at[i] - reach);
            high[i] = index(at[i] + reach);
        }
        while (true) {
            for (std::int32_t k = bucket[bucket_of(cell)]; k >= 0; k = kept[k].next)
                if (within(at, kept[k].at, reach)) candidate.push_back(k);
            int i = 0;
            while (i < grid_size && cell[i] == high[i]) {
                cell[i] = low[i];
                ++i;
            }
            if (i == grid_size) break;
            ++cell[i];
        }
        // Cells that share a bucket give their poses twice.
        std::sort(candidate.begin(), candidate.end());
        candidate.erase(std::unique(candidate.begin(), candidate.end()), candidate.end());
    }

    Source pose;
    double angle;
    CoordinateChart chart;
    std::int64_t number = 0, groups = 0;  ///< poses placed, groups founded
    std::vector<std::int32_t> bucket;     ///< the last kept pose of each
    std::vector<Kept> kept;
    std::vector<std::int32_t> candidate;
};

PoseGroups::PoseGroups(Source pose, std::int64_t count, double angle)
    : impl_(std::make_unique<Impl>(std::move(pose), count, angle)) {}
PoseGroups::~PoseGroups() = default;

PoseGroups::Place PoseGroups::next() {
    Impl& m = *impl_;
    const std::int64_t number = m.number++;
    if (!(m.angle > 0)) return {m.groups++, true, {}};
    const Pose pose = m.pose(number);
    const Coordinates at = m.chart.of(pose);
    m.find_candidates(at);
    Place place;
    double nearest = m.angle;
    for (const std::int32_t k : m.candidate) {
        const double distance = largest_joint_rotation(m.pose(m.kept[k].number), pose);
        if (!(distance < m.angle)) continue;
        if (place.near.empty()) place.group = m.kept[k].group;
        place.near.push_back(m.kept[k].group);
        nearest = std::min(nearest, distance);
    }
    place.founds = place.near.empty();
    if (place.founds) place.group = m.groups++;
    if (nearest >= m.angle / 2) m.keep(at, number, place.group);
    return place;
}

}  // namespace toile::skin

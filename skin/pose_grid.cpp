#include "skin/pose_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace toile::skin {
namespace {

constexpr int reference_count = 3;
constexpr int trial_count = 128;  // poses that tell which coordinates vary most

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
    while (column.size() < PoseGrid::size && value.colwise().squaredNorm().maxCoeff(&next) > 1e-12) {
        column.push_back(next);
        const Eigen::VectorXd direction = value.col(next).normalized();
        value -= direction * (direction.transpose() * value).eval();
        value.col(next).setZero();
    }
    return column;
}

}  // namespace

/// Coordinates of a pose: angles of some joints to those of reference poses. None differs between two poses by more
/// than their largest joint rotation (the triangle inequality), so poses far apart here are far apart.
class PoseGrid::Chart {
  public:
    Chart(const PoseGrid::Source& pose, std::int64_t count) {
        const std::int64_t trials = std::min<std::int64_t>(count, trial_count);
        std::vector<Pose> trial;
        // Spread over the whole sequence: the first poses of a motion may stand still.
        for (std::int64_t i = 0; i < trials; ++i) trial.push_back(pose(i * count / trials));
        std::erase_if(trial, [](const Pose& one) { return !one.allFinite(); });
        if (trial.empty() || trial.front().rows() == 0) return;
        std::vector<Pose> reference;
        for (std::size_t r = 0; r < reference_count; ++r)
            reference.push_back(trial[r * trial.size() / reference_count]);
        std::vector<Axis> axis;
        for (Eigen::Index joint = 0; joint < trial.front().rows(); ++joint)
            for (const Pose& pose_of : reference) axis.push_back({joint, rotation(pose_of, joint).conjugate()});
        Eigen::MatrixXd value(trial.size(), axis.size());
        for (std::size_t i = 0; i < axis.size(); ++i)
            for (std::size_t k = 0; k < trial.size(); ++k) value(k, i) = angle(axis[i], trial[k]);
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

PoseGrid::PoseGrid(const Source& pose, std::int64_t count, double angle)
    : angle_(angle), chart_(std::make_unique<Chart>(pose, count)) {
    std::size_t buckets = 1;
    while (static_cast<std::int64_t>(buckets) < count) buckets *= 2;
    bucket_.assign(buckets, -1);
}

PoseGrid::~PoseGrid() = default;

std::int64_t PoseGrid::index(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / (4 * std::max(angle_, 1e-6))));
}

/// Cells of a layer that share a bucket are only searched needlessly.
std::size_t PoseGrid::bucket_of(const Cell& cell, int layer) const {
    std::uint64_t hash = static_cast<std::uint64_t>(layer);
    for (const std::int64_t c : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
    }
    return hash & (bucket_.size() - 1);
}

PoseGrid::Coordinates PoseGrid::coordinates(const Pose& pose) const {
    return chart_->of(pose);
}

void PoseGrid::insert(const Coordinates& at, int layer) {
    Cell cell;
    for (int i = 0; i < cell_size; ++i) cell[i] = index(at[i]);
    std::int32_t& head = bucket_[bucket_of(cell, layer)];
    entry_.push_back({at, head, layer});
    head = static_cast<std::int32_t>(entry_.size()) - 1;
}

void PoseGrid::find(const Coordinates& at, int layer, std::vector<std::int32_t>& found) const {
    const double reach = angle_ + 1e-5;  // more than the rounding of the coordinates
    const auto within = [&](const Coordinates& other) {
        for (int i = 0; i < size; ++i)
            if (std::abs(at[i] - other[i]) > reach) return false;
        return true;
    };
    Cell low, high, cell;
    for (int i = 0; i < cell_size; ++i) {
        cell[i] = low[i] = index(at[i] - reach);
        high[i] = index(at[i] + reach);
    }
    while (true) {
        for (std::int32_t k = bucket_[bucket_of(cell, layer)]; k >= 0; k = entry_[k].next)
            if (entry_[k].layer == layer && within(entry_[k].at)) found.push_back(k);
        int i = 0;
        while (i < cell_size && cell[i] == high[i]) {
            cell[i] = low[i];
            ++i;
        }
        if (i == cell_size) return;
        ++cell[i];
    }
}

}  // namespace toile::skin

#include "skin/pose_cluster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <unordered_map>

#include "cloth/error.h"

namespace toile::skin {
namespace {

constexpr int grid_joints = 4;    // each makes the grid finer, and triples the cells around one
constexpr int sieve_joints = 12;  // compared before whole poses are: they lie side by side in memory
using Coordinates = std::array<double, sieve_joints>;

/// The rotations of the joints that move in any pose, as unit quaternions.
class Rotations {
  public:
    explicit Rotations(const std::vector<Pose>& pose) {
        const Eigen::Index joints = pose.front().rows();
        std::vector<Eigen::Index> moving;
        for (Eigen::Index j = 0; j < joints; ++j)
            if (std::any_of(pose.begin(), pose.end(), [&](const Pose& p) { return p.row(j) != pose.front().row(j); }))
                moving.push_back(j);
        joints_ = static_cast<int>(moving.size());
        quaternion_.reserve(pose.size() * moving.size());
        for (const Pose& p : pose)
            for (const Eigen::Index j : moving) {
                const Eigen::Vector3d rotation = p.row(j).transpose();
                const double angle = rotation.norm();
                quaternion_.emplace_back(
                    Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(rotation / angle) : Eigen::Vector3d::UnitX()));
            }
    }

    int joints() const { return joints_; }

    /// Distance of two unit quaternions up to sign, squared: (2 sin(angle / 4))^2.
    double squared_chord(int a, int b, int joint) const {
        const Eigen::Vector4d& p = at(a, joint).coeffs();
        const Eigen::Vector4d& q = at(b, joint).coeffs();
        return std::min((p - q).squaredNorm(), (p + q).squaredNorm());
    }
    double angle(int a, int b, int joint) const {
        return 4 * std::asin(std::min(1.0, std::sqrt(squared_chord(a, b, joint)) / 2));
    }
    /// Whether every joint turns by less than `angle` [rad].
    bool near(int a, int b, double angle) const {
        const double chord = 2 * std::sin(std::min(angle, M_PI) / 4);
        for (int joint = 0; joint < joints_; ++joint)
            if (!(squared_chord(a, b, joint) < chord * chord)) return false;
        return angle > 0;
    }

  private:
    const Eigen::Quaterniond& at(int pose, int joint) const {
        return quaternion_[static_cast<std::size_t>(pose) * joints_ + joint];
    }
    int joints_ = 0;
    std::vector<Eigen::Quaterniond> quaternion_;
};

/// Each pose by the angles of the most varying joints to those of pose 0. No coordinate of two poses differs by more
/// than their largest joint rotation (the triangle inequality), so poses far apart here are far apart.
std::vector<Coordinates> grid_coordinates(const Rotations& rotation, int count) {
    std::vector<double> variance(rotation.joints());
    for (int joint = 0; joint < rotation.joints(); ++joint) {
        double sum = 0, squares = 0;
        for (int k = 0; k < count; ++k) {
            const double angle = rotation.angle(0, k, joint);
            sum += angle;
            squares += angle * angle;
        }
        variance[joint] = squares - sum * sum / count;
    }
    std::vector<int> joint(rotation.joints());
    std::iota(joint.begin(), joint.end(), 0);
    std::stable_sort(joint.begin(), joint.end(), [&](int a, int b) { return variance[a] > variance[b]; });
    std::vector<Coordinates> coordinates(count, Coordinates{});
    for (int k = 0; k < count; ++k)
        for (int i = 0; i < std::min<int>(sieve_joints, rotation.joints()); ++i)
            coordinates[k][i] = rotation.angle(0, k, joint[i]);
    return coordinates;
}

/// Poses by the cell their coordinates lie in.
class Grid {
  public:
    explicit Grid(double cell) : cell_(std::max(cell, 1e-6)) {}

    void insert(const Coordinates& at, int pose) {
        std::array<std::int64_t, grid_joints> cell;
        for (int i = 0; i < grid_joints; ++i) cell[i] = index(at[i]);
        poses_[key(cell)].push_back({at, pose});
    }
    /// Calls `visit(pose)` for every pose whose coordinates are within `radius`, until it returns true.
    template <typename Visit>
    bool any_near(const Coordinates& at, double radius, const Visit& visit) const {
        const double reach = radius * (1 + 1e-9) + 1e-12;  // more than the coordinates' rounding
        std::array<std::int64_t, grid_joints> low, high, cell;
        for (int i = 0; i < grid_joints; ++i) {
            cell[i] = low[i] = index(at[i] - reach);
            high[i] = index(at[i] + reach);
        }
        while (true) {
            if (const auto found = poses_.find(key(cell)); found != poses_.end())
                for (const Entry& entry : found->second)
                    if (within(at, entry.at, reach) && visit(entry.pose)) return true;
            int i = 0;
            while (i < grid_joints && cell[i] == high[i]) {
                cell[i] = low[i];
                ++i;
            }
            if (i == grid_joints) return false;
            ++cell[i];
        }
    }

  private:
    struct Entry {
        Coordinates at;
        int pose;
    };
    static bool within(const Coordinates& a, const Coordinates& b, double reach) {
        for (int i = 0; i < sieve_joints; ++i)
            if (std::abs(a[i] - b[i]) > reach) return false;
        return true;
    }
    std::int64_t index(double coordinate) const { return static_cast<std::int64_t>(std::floor(coordinate / cell_)); }
    /// Cells that share a key are only visited needlessly.
    static std::uint64_t key(const std::array<std::int64_t, grid_joints>& cell) {
        std::uint64_t hash = 0;
        for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u + 1;
        return hash;
    }
    double cell_;
    std::unordered_map<std::uint64_t, std::vector<Entry>> poses_;
};

/// Poses within angle/2 of a leader, which are therefore within `angle` of each other. The leader comes first.
std::vector<std::vector<int>> gather(const Rotations& rotation, const std::vector<Coordinates>& at, double angle) {
    std::vector<std::vector<int>> group;
    Grid leaders(angle);
    for (int k = 0; k < static_cast<int>(at.size()); ++k) {
        const bool taken = leaders.any_near(at[k], angle / 2, [&](int g) {
            if (!rotation.near(group[g].front(), k, angle / 2)) return false;
            group[g].push_back(k);
            return true;
        });
        if (taken) continue;
        leaders.insert(at[k], static_cast<int>(group.size()));
        group.push_back({k});
    }
    return group;
}

/// Whether any pose of one group is within `angle` of any of the other.
bool linked(const Rotations& rotation, const std::vector<int>& a, const std::vector<int>& b, double angle) {
    if (rotation.near(a.front(), b.front(), angle)) return true;
    if (!rotation.near(a.front(), b.front(), 2 * angle)) return false;
    std::vector<int> of_a, of_b;
    for (const int k : a)
        if (rotation.near(k, b.front(), 1.5 * angle)) of_a.push_back(k);
    for (const int k : b)
        if (rotation.near(k, a.front(), 1.5 * angle)) of_b.push_back(k);
    for (const int i : of_a)
        for (const int k : of_b)
            if (rotation.near(i, k, angle)) return true;
    return false;
}

void check_poses(const std::vector<Pose>& pose) {
    for (std::size_t k = 0; k < pose.size(); ++k) {
        if (pose[k].rows() != pose.front().rows()) throw Error("pose " + std::to_string(k) + " has other joints");
        if (!pose[k].allFinite()) throw Error("pose " + std::to_string(k) + " is not finite");
    }
}

}  // namespace

std::vector<int> cluster_poses(const std::vector<Pose>& pose, double angle) {
    check_poses(pose);
    const int count = static_cast<int>(pose.size());
    std::vector<int> label(count);
    std::iota(label.begin(), label.end(), 0);
    if (count == 0 || !(angle > 0)) return label;

    const Rotations rotation(pose);
    const std::vector<Coordinates> at = grid_coordinates(rotation, count);
    const std::vector<std::vector<int>> group = gather(rotation, at, angle);

    const int groups = static_cast<int>(group.size());
    std::vector<int> rank(groups), parent(groups);
    boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
    for (int g = 0; g < groups; ++g) sets.make_set(g);
    Grid leaders(2 * angle);
    for (int g = 0; g < groups; ++g) {
        leaders.any_near(at[group[g].front()], 2 * angle, [&](int other) {
            if (sets.find_set(g) != sets.find_set(other) && linked(rotation, group[g], group[other], angle))
                sets.union_set(g, other);
            return false;
        });
        leaders.insert(at[group[g].front()], g);
    }
    // Leaders are in the order of the poses, and each is the first of its group: the first group of a set names it.
    std::vector<int> name(groups, -1);
    for (int g = 0; g < groups; ++g) {
        int& first = name[sets.find_set(g)];
        if (first < 0) first = group[g].front();
        for (const int k : group[g]) label[k] = first;
    }
    return label;
}

}  // namespace toile::skin

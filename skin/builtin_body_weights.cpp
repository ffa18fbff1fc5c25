#include "skin/builtin_body_weights.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace toile::skin {
namespace {

constexpr double diffusion_length = 0.028;  // standard deviation of the heat kernel [m]
constexpr int most_influences = 4;

using Shares = std::array<double, role_count>;

/// 0 up to `from`, 1 beyond `to`, smooth between; `from` may be the larger.
double ramp(double from, double to, double value) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// Roles of one side of the body: the left ones moved to the right where `left` is false.
Role of_side(Role left_role, bool left) {
    if (left) return left_role;
    const bool arm = left_role < Role::right_clavicle;
    const int shift = arm ? static_cast<int>(Role::right_clavicle) - static_cast<int>(Role::left_clavicle)
                          : static_cast<int>(Role::right_upper_leg) - static_cast<int>(Role::left_upper_leg);
    return static_cast<Role>(static_cast<int>(left_role) + shift);
}

/// Shares out points by their place along the limbs.
class Partition {
  public:
    Partition(const BuiltinJoints& joint, double girth) : joint_(joint), girth_(girth) {}

    Shares operator()(const Eigen::Vector3d& point) const {
        Shares share{};
        const bool left = point.x() >= 0.0;
        const Eigen::Vector3d mirrored(std::abs(point.x()), point.y(), point.z());
        const auto give = [&](Role role, double value) { share[static_cast<int>(role)] += value; };
        const double arm = arm_share(mirrored), rest = 1.0 - arm;
        const double elbow = ramp(-0.045, 0.045, along_arm(mirrored, joint_.lower_arm));
        const double wrist = ramp(-0.03, 0.03, along_arm(mirrored, joint_.hand));
        give(of_side(Role::left_upper_arm, left), arm * (1.0 - elbow));
        give(of_side(Role::left_lower_arm, left), arm * (elbow - wrist));
        give(of_side(Role::left_hand, left), arm * wrist);
        const double leg = rest * leg_share(mirrored);
        const double knee = ramp(0.045, -0.045, point.y() - joint_.lower_leg.y());
        const double ankle = ramp(0.035, -0.025, point.y() - joint_.foot.y() - 0.3 * (point.z() - joint_.foot.z()));
        const double own = 0.5 * (1.0 + ramp(0.0, 0.02, mirrored.x()));  // both legs share the crotch
        for (const bool side : {left, !left}) {
            const double part = leg * (side == left ? own : 1.0 - own);
            give(of_side(Role::left_upper_leg, side), part * (1.0 - knee));
            give(of_side(Role::left_lower_leg, side), part * knee * (1.0 - ankle));
            give(of_side(Role::left_foot, side), part * knee * ankle);
        }
        const double trunk = rest - leg, clavicle = trunk * clavicle_share(mirrored);
        give(of_side(Role::left_clavicle, left), clavicle);
        add_trunk(point, trunk - clavicle, share);
        return share;
    }

  private:
    double along_arm(const Eigen::Vector3d& point, const Eigen::Vector3d& from) const {
        return (point - from).dot((joint_.hand - joint_.upper_arm).normalized());
    }
    /// Beyond the shoulder along the arm, and about the arm rather than the chest beneath it.
    double arm_share(const Eigen::Vector3d& point) const {
        const Eigen::Vector3d arm = (joint_.hand - joint_.upper_arm).normalized();
        const double radius = (point - joint_.upper_arm).cross(arm).norm();
        const double along = along_arm(point, joint_.upper_arm);
        const double clear = 0.06 * ramp(0.25, 0.45, along);  // out here only the thumb is far from the axis
        return ramp(-0.05, 0.08, along) * ramp(0.094 * girth_ + clear, 0.062 * girth_ + clear, radius);
    }
    double leg_share(const Eigen::Vector3d& point) const {
        // The border follows the groin: higher at the outside.
        const double border = joint_.upper_leg.y() - 0.055 + 0.55 * std::min(point.x(), 0.2);
        return ramp(0.06, -0.06, point.y() - border);
    }
    double clavicle_share(const Eigen::Vector3d& point) const {
        return ramp(0.03, 0.13 * std::pow(girth_, 0.6), point.x()) * ramp(1.28, 1.40, point.y()) *
               ramp(1.52, 1.46, point.y());
    }
    void add_trunk(const Eigen::Vector3d& point, double trunk, Shares& share) const {
        const double spine = ramp(-0.06, 0.06, point.y() - joint_.spine.y() + 0.02);
        const double chest = ramp(-0.06, 0.06, point.y() - joint_.chest.y() + 0.02);
        const double neck = ramp(-0.05, 0.04, point.y() - joint_.neck.y() - 0.3 * (point.z() - joint_.neck.z()));
        const double head = ramp(-0.03, 0.025, point.y() - joint_.head.y() + 0.6 * (point.z() - joint_.head.z()));
        share[static_cast<int>(Role::pelvis)] += trunk * (1.0 - spine);
        share[static_cast<int>(Role::spine)] += trunk * (spine - chest * spine);
        share[static_cast<int>(Role::chest)] += trunk * spine * chest * (1.0 - neck);
        share[static_cast<int>(Role::neck)] += trunk * spine * chest * neck * (1.0 - head);
        share[static_cast<int>(Role::head)] += trunk * spine * chest * neck * head;
    }

    BuiltinJoints joint_;
    double girth_;
};

/// M + t L of the surface: lumped areas and cotangents, the latter kept from below so that shares stay positive.
Eigen::SparseMatrix<double> heat_step(const Surface& surface, double time, Eigen::VectorXd& area) {
    const auto count = surface.position.rows();
    area = Eigen::VectorXd::Zero(count);
    std::vector<Eigen::Triplet<double>> entry;
    for (Eigen::Index f = 0; f < surface.triangle.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int i = surface.triangle(f, c), a = surface.triangle(f, (c + 1) % 3),
                      b = surface.triangle(f, (c + 2) % 3);
            const Eigen::Vector3d u = (surface.position.row(a) - surface.position.row(i)).transpose();
            const Eigen::Vector3d v = (surface.position.row(b) - surface.position.row(i)).transpose();
            const double twice_area = u.cross(v).norm();
            const double weight = time * 0.5 * std::clamp(u.dot(v) / std::max(twice_area, 1e-12), 0.05, 20.0);
            area[i] += twice_area / 6.0;
            entry.insert(entry.end(), {{a, a, weight}, {b, b, weight}, {a, b, -weight}, {b, a, -weight}});
        }
    for (Eigen::Index i = 0; i < count; ++i) entry.emplace_back(static_cast<int>(i), static_cast<int>(i), area[i]);
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entry.begin(), entry.end());
    return matrix;
}

/// The largest shares of each vertex, made to sum to one.
SkinWeights largest_shares(const Eigen::MatrixXd& share) {
    SkinWeights weight;
    weight.offset.push_back(0);
    for (Eigen::Index v = 0; v < share.rows(); ++v) {
        std::array<int, role_count> order;
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return share(v, a) > share(v, b); });
        int kept = 1;
        double sum = share(v, order[0]);
        while (kept < most_influences && share(v, order[kept]) > 1e-4) sum += share(v, order[kept++]);
        std::sort(order.begin(), order.begin() + kept);
        for (int k = 0; k < kept; ++k) {
            weight.joint.push_back(order[k]);
            weight.value.push_back(share(v, order[k]) / sum);
        }
        weight.offset.push_back(static_cast<int>(weight.joint.size()));
    }
    return weight;
}

}  // namespace

SkinWeights builtin_weights(const Surface& surface, const BuiltinJoints& joint, double girth) {
    const Partition partition(joint, girth);
    Eigen::MatrixXd share(surface.position.rows(), role_count);
    for (Eigen::Index v = 0; v < share.rows(); ++v) {
        const Shares shares = partition(surface.position.row(v));
        for (int role = 0; role < role_count; ++role) share(v, role) = shares[static_cast<size_t>(role)];
    }
    Eigen::VectorXd area;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> heat(
        heat_step(surface, 0.5 * diffusion_length * diffusion_length, area));
    const Eigen::MatrixXd heated = area.asDiagonal() * share;
    return largest_shares(heat.solve(heated));
}

}  // namespace toile::skin

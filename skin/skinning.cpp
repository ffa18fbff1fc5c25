#include "skin/skinning.h"

#include <cmath>

namespace toile::skin {
namespace {

using AffineRows = Eigen::Matrix<double, 3, 4>;

/// A rigid motion as a unit dual quaternion, each part stored (x, y, z, w).
struct DualQuaternion {
    Eigen::Vector4d real;
    Eigen::Vector4d dual;
};

std::vector<Eigen::Quaterniond> rotations(const std::vector<Eigen::Matrix4d>& transform) {
    std::vector<Eigen::Quaterniond> rotation(transform.size());
    for (size_t j = 0; j < transform.size(); ++j)
        rotation[j] = Eigen::Quaterniond(Eigen::Matrix3d(transform[j].topLeftCorner<3, 3>())).normalized();
    return rotation;
}

Positions skin_linear(const Body& body, const std::vector<Eigen::Matrix4d>& transform) {
    std::vector<AffineRows> affine(transform.size());
    for (size_t j = 0; j < transform.size(); ++j) affine[j] = transform[j].topRows<3>();
    Positions posed(body.vertex_count(), 3);
    for (int v = 0; v < body.vertex_count(); ++v) {
        AffineRows blend = AffineRows::Zero();
        for (int i = body.weight.offset[v]; i < body.weight.offset[v + 1]; ++i)
            blend += body.weight.value[i] * affine[body.weight.joint[i]];
        posed.row(v) = (blend.leftCols<3>() * body.rest_position.row(v).transpose() + blend.col(3)).transpose();
    }
    return posed;
}

std::vector<DualQuaternion> dual_quaternions(const std::vector<Eigen::Matrix4d>& transform) {
    const std::vector<Eigen::Quaterniond> rotation = rotations(transform);
    std::vector<DualQuaternion> motion(transform.size());
    for (size_t j = 0; j < transform.size(); ++j) {
        const Eigen::Vector3d t = transform[j].topRightCorner<3, 1>();
        motion[j].real = rotation[j].coeffs();
        motion[j].dual = 0.5 * (Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * rotation[j]).coeffs();
    }
    return motion;
}

Eigen::Vector3d moved(const DualQuaternion& blend, const Eigen::Vector3d& point) {
    const double scale = 1 / blend.real.norm();
    const Eigen::Vector3d r = blend.real.head<3>() * scale, d = blend.dual.head<3>() * scale;
    const double rw = blend.real[3] * scale, dw = blend.dual[3] * scale;
    const Eigen::Vector3d turned = point + 2 * r.cross(r.cross(point) + rw * point);
    return turned + 2 * (rw * d - dw * r + r.cross(d));
}

Positions skin_dual_quaternion(const Body& body, const std::vector<Eigen::Matrix4d>& transform) {
    const std::vector<DualQuaternion> motion = dual_quaternions(transform);
    Positions posed(body.vertex_count(), 3);
    for (int v = 0; v < body.vertex_count(); ++v) {
        const Eigen::Vector4d& pivot = motion[heaviest_joint(body.weight, v)].real;
        DualQuaternion blend{Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};
        for (int i = body.weight.offset[v]; i < body.weight.offset[v + 1]; ++i) {
            const DualQuaternion& term = motion[body.weight.joint[i]];
            const double w = std::copysign(body.weight.value[i], pivot.dot(term.real));
            blend.real += w * term.real;
            blend.dual += w * term.dual;
        }
        posed.row(v) = moved(blend, body.rest_position.row(v).transpose()).transpose();
    }
    return posed;
}

}  // namespace

int heaviest_joint(const SkinWeights& weight, int v) {
    int heaviest = weight.offset[v];
    for (int i = weight.offset[v] + 1; i < weight.offset[v + 1]; ++i)
        if (weight.value[i] > weight.value[heaviest]) heaviest = i;
    return weight.joint[heaviest];
}

std::vector<bool> joints_below(const Body& body, int top) {
    std::vector<bool> below(static_cast<size_t>(body.joint_count()), false);
    for (int j = 0; j < body.joint_count(); ++j)
        below[j] = j == top || (body.joint[j].parent >= 0 && below[body.joint[j].parent]);
    return below;
}

Positions skin_positions(const Body& body, const Pose& pose, SkinningMethod method) {
    const std::vector<Eigen::Matrix4d> transform = skinning_transforms(body, pose);
    return method == SkinningMethod::linear ? skin_linear(body, transform) : skin_dual_quaternion(body, transform);
}

std::vector<Eigen::Quaterniond> blended_rotations(const Body& body, const Pose& pose) {
    const std::vector<Eigen::Quaterniond> rotation = rotations(skinning_transforms(body, pose));
    std::vector<Eigen::Quaterniond> blended(static_cast<size_t>(body.vertex_count()));
    for (int v = 0; v < body.vertex_count(); ++v) {
        const Eigen::Vector4d pivot = rotation[heaviest_joint(body.weight, v)].coeffs();
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int i = body.weight.offset[v]; i < body.weight.offset[v + 1]; ++i) {
            const Eigen::Vector4d& q = rotation[body.weight.joint[i]].coeffs();
            sum += std::copysign(body.weight.value[i], pivot.dot(q)) * q;
        }
        blended[v] = Eigen::Quaterniond(sum.normalized());
    }
    return blended;
}

}  // namespace toile::skin

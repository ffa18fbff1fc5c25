#include "skin/body.h"

#include <Eigen/LU>
#include <cmath>

#include "cloth/error.h"

namespace toile::skin {
namespace {

void check_surface(const Body& body, const std::string& where) {
    if (body.triangle.rows() == 0) throw Error("the body has no faces", where);
    for (int v = 0; v < body.vertex_count(); ++v)
        if (!body.rest_position.row(v).allFinite())
            throw Error("body vertex " + std::to_string(v) + " is not finite", where);
    for (int f = 0; f < body.triangle.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int v = body.triangle(f, corner);
            if (v < 0 || v >= body.vertex_count())
                throw Error("body triangle " + std::to_string(f) + " refers to vertex " + std::to_string(v) + " of " +
                                std::to_string(body.vertex_count()),
                            where);
        }
    }
}

void check_skeleton(const Body& body, const std::string& where) {
    if (body.joint.empty()) throw Error("the body has no joints", where);
    for (int j = 0; j < body.joint_count(); ++j) {
        const Joint& joint = body.joint[j];
        const std::string name = "joint '" + joint.name + "'";
        if (joint.parent < -1 || joint.parent >= j || (joint.parent == -1 && j > 0))
            throw Error(name + " (" + std::to_string(j) + ") has parent " + std::to_string(joint.parent) +
                            ": parents come first and only joint 0 has none",
                        where);
        const Eigen::Matrix3d r = joint.bind.topLeftCorner<3, 3>();
        if (!joint.bind.allFinite() || (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-6 ||
            r.determinant() < 0 || joint.bind.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
            throw Error("the bind transform of " + name + " is not rigid", where);
    }
    for (int i = 0; i < role_count; ++i)
        if (body.role.joint[i] < -1 || body.role.joint[i] >= body.joint_count())
            throw Error("role " + std::string(role_name(static_cast<Role>(i))) + " refers to joint " +
                            std::to_string(body.role.joint[i]) + " of " + std::to_string(body.joint_count()),
                        where);
}

void check_vertex_weights(const Body& body, int v, const std::string& where) {
    const SkinWeights& weight = body.weight;
    double sum = 0;
    for (int i = weight.offset[v]; i < weight.offset[v + 1]; ++i) {
        if (weight.joint[i] < 0 || weight.joint[i] >= body.joint_count())
            throw Error("body vertex " + std::to_string(v) + " hangs on joint " + std::to_string(weight.joint[i]) +
                            " of " + std::to_string(body.joint_count()),
                        where);
        if (!(weight.value[i] >= 0))
            throw Error("body vertex " + std::to_string(v) + " has the weight " + std::to_string(weight.value[i]),
                        where);
        sum += weight.value[i];
    }
    if (!(std::abs(sum - 1) <= 1e-6))
        throw Error("the weights of body vertex " + std::to_string(v) + " sum to " + std::to_string(sum), where);
}

void check_weights(const Body& body, const std::string& where) {
    const SkinWeights& weight = body.weight;
    if (static_cast<int>(weight.offset.size()) != body.vertex_count() + 1 || weight.offset.front() != 0 ||
        weight.offset.back() != static_cast<int>(weight.joint.size()) || weight.joint.size() != weight.value.size())
        throw Error("the skin weights do not fit the " + std::to_string(body.vertex_count()) + " body vertices", where);
    for (int v = 0; v < body.vertex_count(); ++v)
        if (weight.offset[v] > weight.offset[v + 1])
            throw Error("the skin weights of body vertex " + std::to_string(v) + " are out of order", where);
    for (int v = 0; v < body.vertex_count(); ++v) check_vertex_weights(body, v, where);
}

}  // namespace

void check_body(const Body& body, const std::string& where) {
    check_surface(body, where);
    check_skeleton(body, where);
    check_weights(body, where);
}

}  // namespace toile::skin

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/embedding.h"
#include "pattern/garment_file.h"
#include "pattern/tshirt.h"
#include "skin/anatomy.h"
#include "skin/builtin_body.h"
#include "tests/pattern/slow_build.h"
#include "tests/pattern/tube_garment.h"

namespace toile::pattern {
namespace {

using skin::Role;

/// A column of two joints, the upper one at y = 0.2, its weights smooth.
skin::Body bending_column() {
    skin::Body body = column_body(0.17, -0.2, 0.6);
    Eigen::Matrix4d root = Eigen::Matrix4d::Identity(), upper = root;
    // Bind frames that are not the identity.
    root.topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    upper(1, 3) = 0.2;
    body.joint = {{"root", -1, root}, {"upper", 0, upper}};
    body.weight.offset = {0};
    for (int v = 0; v < body.vertex_count(); ++v) {
        const double share = 1.0 / (1.0 + std::exp(-(body.rest_position(v, 1) - 0.2) / 0.05));
        body.weight.joint.insert(body.weight.joint.end(), {0, 1});
        body.weight.value.insert(body.weight.value.end(), {1.0 - share, share});
        body.weight.offset.push_back(static_cast<int>(body.weight.joint.size()));
    }
    return body;
}

ClothMesh tube() {
    return garment_from_mesh(tube_garment(), {}, nullptr, "tube").mesh;
}

skin::Pose pose_of(const skin::Body& body, const Eigen::Vector3d& root, const Eigen::Vector3d& upper) {
    skin::Pose pose = skin::Pose::Zero(body.joint_count(), 3);
    pose.row(0) = root;
    pose.row(1) = upper;
    return pose;
}

EmbeddedCloth carried(const Embedding& embedding, const skin::Body& body, const skin::Pose& pose) {
    return carry(embedding, body, pose, skin::skin_positions(body, pose, skin::SkinningMethod::linear));
}

TEST(Embedding, neutral_pose_gives_the_nearest_points_and_pattern_axes) {
    const skin::Body body = bending_column();
    const ClothMesh cloth = tube();
    const Embedding embedding = embed(cloth, body);
    const EmbeddedCloth neutral = carried(embedding, body, pose_of(body, {0, 0, 0}, {0, 0, 0}));
    const Positions d = displacement(neutral, cloth.rest_position);
    for (int v = 0; v < cloth.vertex_count(); ++v) {
        EXPECT_NEAR(embedding.barycentric.row(v).sum(), 1.0, 1e-12);
        EXPECT_GE(embedding.barycentric.row(v).minCoeff(), 0.0);
        // The tube is 3 cm off the column: nearly all of the displacement is along the normal.
        EXPECT_NEAR(d(v, 2), 0.03, 0.003) << v;
        EXPECT_LT(d.row(v).head<2>().norm(), 0.006) << v;
        const Eigen::Vector3d out(cloth.rest_position(v, 0), 0, cloth.rest_position(v, 2));
        const Eigen::Vector3d u = neutral.frame[v] * Eigen::Vector3d::UnitX();
        EXPECT_GT(u.dot(Eigen::Vector3d::UnitY().cross(out.normalized())), 0.99) << v;  // around, to the left in front
        EXPECT_GT((neutral.frame[v] * Eigen::Vector3d::UnitZ()).dot(out.normalized()), 0.99) << v;
        EXPECT_GE(neutral.frame[v].w(), 0.0);
        EXPECT_NEAR(neutral.frame[v].norm(), 1.0, 1e-14);
    }
}

TEST(Embedding, displacement_gives_the_cloth_back) {
    const skin::Body body = bending_column();
    const ClothMesh cloth = tube();
    const EmbeddedCloth embedded = carried(embed(cloth, body), body, pose_of(body, {0.3, 0, 0.1}, {0, 0.4, 1.1}));
    Positions draped = cloth.rest_position;
    for (int v = 0; v < draped.rows(); ++v) draped.row(v) += Eigen::RowVector3d(0.05 * std::sin(3.0 * v), 0.02, 0.1);
    EXPECT_LT((displaced(embedded, displacement(embedded, draped)) - draped).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Embedding, identity_holds_for_what_float32_keeps) {
    const skin::Body body = bending_column();
    const ClothMesh cloth = tube();
    const EmbeddedCloth stored =
        rounded(carried(embed(cloth, body), body, pose_of(body, {0.3, 0, 0.1}, {0, 0.4, 1.1})));
    const Positions draped = (cloth.rest_position.array() + 1.5).matrix().cast<float>().cast<double>();
    const Positions kept = displacement(stored, draped).cast<float>().cast<double>();
    EXPECT_LT((displaced(stored, kept) - draped).rowwise().norm().maxCoeff(), 5e-7);
}

TEST(Embedding, rigid_motion_of_the_body_leaves_displacements_alone) {
    const skin::Body body = bending_column();
    const ClothMesh cloth = tube();
    const Embedding embedding = embed(cloth, body);
    const Eigen::Vector3d bend(0, 0.4, 1.1);
    const EmbeddedCloth one = carried(embedding, body, pose_of(body, {0, 0, 0}, bend));
    Positions draped = cloth.rest_position;
    draped.col(1).array() += 0.05;
    const Positions d = displacement(one, draped);
    for (const Eigen::Vector3d& turn :
         {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, 3.0, 0.2), Eigen::Vector3d(-2, 1.2, 2)}) {
        const EmbeddedCloth other = carried(embedding, body, pose_of(body, turn, bend));
        // The root turns by B R B^-1 in the world, and its bind frame has no translation.
        const Eigen::Matrix3d bind = body.joint[0].bind.topLeftCorner<3, 3>();
        const Eigen::Matrix3d world =
            bind * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * bind.transpose();
        const Positions moved = draped * world.transpose();
        EXPECT_LT((displacement(other, moved) - d).cwiseAbs().maxCoeff(), 1e-9);
        for (size_t v = 0; v < other.frame.size(); ++v) EXPECT_GE(other.frame[v].w(), 0.0);
    }
}

TEST(Embedding, u_axis_along_the_normal_is_replaced_by_its_neighbours) {
    const skin::Body body = bending_column();
    ClothMesh cloth = tube();
    const Embedding sound = embed(cloth, body);
    // Turn the pattern so that u runs up, and lift a fold so that u points outwards there.
    cloth.pattern_position.col(0).swap(cloth.pattern_position.col(1));
    cloth.pattern_position.col(0) *= -1.0;
    for (int v = 0; v < cloth.vertex_count(); ++v)
        if (std::abs(cloth.rest_position(v, 1) - 0.2) < 0.01)
            cloth.rest_position.row(v).array() *= Eigen::Array<double, 1, 3>(1.6, 1, 1.6);
    const Embedding folded = embed(cloth, body);
    for (int v = 0; v < cloth.vertex_count(); ++v) {
        EXPECT_NEAR(folded.tangent.row(v).norm(), 1.0, 1e-12);
        EXPECT_NEAR(folded.normal.row(v).norm(), 1.0, 1e-12);
        EXPECT_NEAR(folded.tangent.row(v).dot(folded.normal.row(v)), 0.0, 1e-12);
        EXPECT_LT(std::abs(folded.tangent.row(v).dot(sound.tangent.row(v))), 0.5) << v;
    }
}

TEST(Embedding, refuses_a_posed_body_of_another_size) {
    const skin::Body body = bending_column();
    const Embedding embedding = embed(tube(), body);
    EXPECT_THROW(carry(embedding, body, pose_of(body, {0, 0, 0}, {0, 0, 0}), Positions::Zero(3, 3)), Error);
}

TEST(Embedding, frames_of_a_tshirt_are_smooth_over_cloth_and_poses) {
    TOILE_SKIP_IN_SLOW_BUILD();
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    const Garment shirt = make_tshirt(body, {.edge_length = 0.03});
    const Embedding embedding = embed(shirt.mesh, body);
    const Edges edge = build_topology(shirt.mesh.triangle).edge;
    std::vector<Eigen::Quaterniond> last;
    const double first = -1.4, step = 0.2;
    for (int k = 0; k <= 14; ++k) {  // from hanging to overhead
        skin::RoleAngles angles;
        angles.angle[Role::left_upper_arm] = {first + k * step, 0, 0};
        angles.angle[Role::right_upper_arm] = {first + k * step, 0, 0};
        const EmbeddedCloth embedded = carried(embedding, body, skin::pose_from_angles(body, angles));
        // Below each arm there is one point about which the frames turn once; a few edges lie across it.
        int beyond_radian = 0, beyond_right = 0;
        double sum = 0.0;
        for (int e = 0; e < edge.rows(); ++e) {
            const double angle = embedded.frame[edge(e, 0)].angularDistance(embedded.frame[edge(e, 1)]);
            beyond_radian += angle > 1.0;
            beyond_right += angle > 1.6;
            sum += angle;
        }
        EXPECT_LE(beyond_right, 2 * 8);
        EXPECT_LT(beyond_radian, 0.015 * static_cast<double>(edge.rows()));
        EXPECT_LT(sum / static_cast<double>(edge.rows()), 0.25);
        for (size_t v = 0; v < last.size(); ++v) EXPECT_LT(last[v].angularDistance(embedded.frame[v]), 1.1 * step) << v;
        last = embedded.frame;
    }
}

}  // namespace
}  // namespace toile::pattern

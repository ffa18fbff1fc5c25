#include <gmock/gmock.h>

#include <cmath>

#include "cloth/error.h"
#include "skin/bind_skeleton.h"

namespace toile::skin {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

Affine3d turned(const Vector3d& at, double angle) {
    return Eigen::Translation3d(at) * AngleAxisd(angle, Vector3d(1, 2, 3).normalized());
}

/// A chain root - a - b - c with a side branch d on a, under a node that is no joint; the tree is in the bind pose.
struct Chain {
    files::RiggedFile file;
    std::vector<Affine3d> bind;  // by node

    Chain() {
        bind = {turned({9, 9, 9}, 1.0),   turned({0, 1, 0}, 0.2),   turned({0, 2, 0.3}, -0.4),
                turned({0.2, 3, 0}, 0.9), turned({0, 4, 0.1}, 0.1), turned({1, 2.5, 0}, 1.4)};
        const int parent[] = {-1, 0, 1, 2, 3, 2};
        const char* name[] = {"scene", "root", "a", "b", "c", "d"};
        for (int n = 0; n < 6; ++n) {
            const Affine3d local = parent[n] < 0 ? bind[n] : bind[parent[n]].inverse() * bind[n];
            file.node.push_back({name[n], parent[n], local.matrix()});
        }
    }
    /// A mesh whose stored space is carried to bind space by `space`, with bones at these nodes.
    void add_mesh(const std::vector<int>& nodes, const Affine3d& space = Affine3d::Identity()) {
        files::RiggedMesh mesh;
        mesh.name = "mesh" + std::to_string(file.mesh.size());
        for (const int n : nodes) mesh.bone.push_back({file.node[n].name, n, (bind[n].inverse() * space).matrix()});
        file.mesh.push_back(mesh);
    }
    void pose_tree() {
        for (size_t n = 1; n < file.node.size(); ++n)
            file.node[n].local.topLeftCorner<3, 3>() *=
                AngleAxisd(0.7 * static_cast<double>(n), Vector3d(3, 1, 2).normalized()).toRotationMatrix();
    }
    void expect_bind(const BindSkeleton& skeleton, int node, double tolerance) const {
        const int joint = skeleton.joint_of_node[node];
        ASSERT_GE(joint, 0) << node;
        EXPECT_LT((skeleton.joint[joint].bind.matrix() - bind[node].matrix()).cwiseAbs().maxCoeff(), tolerance) << node;
    }
};

TEST(BindSkeleton, InvertsTheOffsetsWhateverTheTreeDoes) {
    Chain chain;
    chain.add_mesh({1, 2, 3, 4, 5});
    chain.pose_tree();
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0}, "x");
    ASSERT_EQ(skeleton.joint.size(), 5u);
    for (int n = 1; n < 6; ++n) chain.expect_bind(skeleton, n, 1e-12);
    EXPECT_EQ(skeleton.joint_of_node[0], -1);
    EXPECT_EQ(skeleton.joint[0].parent, -1);
    EXPECT_EQ(skeleton.joint[4].parent, 1);
}

TEST(BindSkeleton, FillsJointsTheSkinLeavesOutFromTheTree) {
    Chain chain;
    chain.add_mesh({1, 3, 4, 5});  // a is missing
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0}, "x");
    ASSERT_EQ(skeleton.joint.size(), 5u);
    chain.expect_bind(skeleton, 2, 1e-6);
}

TEST(BindSkeleton, FitsALeftOutJointToItsNeighboursWhenTheTreeIsPosed) {
    Chain chain;
    chain.add_mesh({1, 3, 4, 5});
    // The tree's joint a is turned, so its own rotation there is no guide; its bone lengths are.
    chain.file.node[2].local.topLeftCorner<3, 3>() *= AngleAxisd(0.8, Vector3d::UnitX()).toRotationMatrix();
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0}, "x");
    chain.expect_bind(skeleton, 2, 1e-5);
}

TEST(BindSkeleton, TakesTheCommonAncestorOfSeveralTopJointsAsRoot) {
    Chain chain;
    chain.add_mesh({4, 5});  // c and d meet at a, by way of b
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0}, "x");
    ASSERT_EQ(skeleton.joint.size(), 4u);
    EXPECT_EQ(chain.file.node[skeleton.joint[0].node].name, "a");
    for (const int n : {2, 3, 4, 5}) chain.expect_bind(skeleton, n, 1e-6);
    EXPECT_EQ(skeleton.joint_of_node[1], -1);
}

TEST(BindSkeleton, PlacesMeshesWithoutACommonJointByTheScene) {
    Chain chain;
    const Affine3d space = Eigen::Translation3d(1, 2, 3) * AngleAxisd(1, Vector3d::UnitZ()) * Eigen::Scaling(2.0);
    chain.add_mesh({1, 2});
    chain.add_mesh({3, 4}, space);
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0, 1}, "x");
    for (const int n : {1, 2, 3, 4}) chain.expect_bind(skeleton, n, 1e-12);
    EXPECT_TRUE(skeleton.placement[1][0].isApprox(space, 1e-12));
    EXPECT_TRUE(skeleton.remarks.empty());
}

TEST(BindSkeleton, PosesAMeshBoundInAnotherPose) {
    Chain chain;
    chain.add_mesh({1, 2, 3});
    chain.add_mesh({2, 3});
    chain.file.mesh[1].bone[1].offset = (turned({0, 0, 1}, 0.3) * Affine3d(chain.file.mesh[1].bone[1].offset)).matrix();
    const BindSkeleton skeleton = bind_skeleton(chain.file, {0, 1}, "x");
    EXPECT_THAT(skeleton.remarks, testing::ElementsAre(testing::HasSubstr("'mesh1' was bound in another pose")));
    EXPECT_TRUE(skeleton.placement[1][0].isApprox(Affine3d::Identity(), 1e-12));
    EXPECT_FALSE(skeleton.placement[1][1].isApprox(Affine3d::Identity(), 0.01));
}

TEST(BindSkeleton, RefusesMirrorsAndSingularOffsets) {
    Chain chain;
    chain.add_mesh({1, 2});
    chain.file.mesh[0].bone[1].offset.row(0) *= -1;
    EXPECT_THROW(bind_skeleton(chain.file, {0}, "x"), Error);
    chain.file.mesh[0].bone[1].offset.row(0).setZero();
    EXPECT_THROW(bind_skeleton(chain.file, {0}, "x"), Error);
}

}  // namespace
}  // namespace toile::skin

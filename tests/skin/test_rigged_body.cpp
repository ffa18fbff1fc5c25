#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "skin/rigged_body.h"
#include "skin/skinning.h"
#include "tests/support/rigged_gltf.h"

namespace toile::skin {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using testing::HasSubstr;
using namespace toile::testing_support;

Matrix4d matrix(const Eigen::Affine3d& transform) {
    return transform.matrix();
}

GltfScene person() {
    return box_person(mixamo_names());
}

RiggedBody read(const GltfScene& scene, const RiggedBodyOptions& options = {}) {
    return read_rigged_body(write_test_file("body.gltf", gltf_text(scene)), options);
}

Pose wavy_pose(const Body& body) {
    Pose pose(body.joint_count(), 3);
    for (int i = 0; i < pose.size(); ++i) pose.data()[i] = 0.6 * std::sin(1.7 * i + 0.3);
    return pose;
}

/// Linear blend skinning from the scene itself: G_j times the inverse bind matrix, joint by joint.
Positions independent_skinning(const GltfScene& scene, const Pose& pose) {
    std::vector<Matrix4d> world(scene.node.size());
    std::vector<Matrix4d> bind;
    for (const Matrix4d& inverse : scene.skin[0].inverse_bind) bind.push_back(inverse.inverse());
    for (size_t j = 0; j < scene.node.size(); ++j) {
        const int parent = scene.node[j].parent;
        const Vector3d rotation = pose.row(static_cast<long>(j)).transpose();
        const Matrix4d turn = matrix(Eigen::Affine3d(Eigen::AngleAxisd(rotation.norm(), rotation.normalized())));
        world[j] =
            parent < 0 ? Matrix4d(bind[j] * turn) : Matrix4d(world[parent] * bind[parent].inverse() * bind[j] * turn);
    }
    const GltfMesh& mesh = scene.mesh[0];
    Positions posed = Positions::Zero(mesh.position.rows(), 3);
    for (int v = 0; v < posed.rows(); ++v)
        for (const auto& [joint, weight] : mesh.influence[v])
            posed.row(v) +=
                weight * (world[joint] * bind[joint].inverse() * mesh.position.row(v).transpose().homogeneous())
                             .head<3>()
                             .transpose();
    return posed;
}

void expect_same_body(const Body& actual, const Body& expected, double tolerance) {
    ASSERT_EQ(actual.vertex_count(), expected.vertex_count());
    ASSERT_EQ(actual.joint_count(), expected.joint_count());
    EXPECT_LT((actual.rest_position - expected.rest_position).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_EQ(actual.triangle, expected.triangle);
    for (int j = 0; j < expected.joint_count(); ++j) {
        EXPECT_EQ(actual.joint[j].name, expected.joint[j].name);
        EXPECT_EQ(actual.joint[j].parent, expected.joint[j].parent);
    }
    EXPECT_EQ(actual.role.joint, expected.role.joint);
    const Pose pose = wavy_pose(expected);
    for (const SkinningMethod method : {SkinningMethod::linear, SkinningMethod::dual_quaternion})
        EXPECT_LT((skin_positions(actual, pose, method) - skin_positions(expected, pose, method)).cwiseAbs().maxCoeff(),
                  2 * tolerance);
}

void expect_refused(const GltfScene& scene, const std::vector<std::string>& words,
                    const RiggedBodyOptions& options = {}) {
    try {
        read(scene, options);
        ADD_FAILURE() << "accepted: " << words[0];
    } catch (const Error& error) {
        for (const std::string& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
        EXPECT_THAT(error.where(), HasSubstr("body.gltf"));
    }
}

TEST(ReadRiggedBody, TakesAPersonAsItIs) {
    const RiggedBody read_body = read(person());
    const Body& body = read_body.body;
    EXPECT_THAT(read_body.remarks, testing::IsEmpty());
    EXPECT_EQ(body.vertex_count(), 19 * 8);
    EXPECT_EQ(body.joint_count(), 19);
    EXPECT_TRUE(body.role.missing().empty());
    EXPECT_NEAR(body.rest_position.col(1).minCoeff(), 0, 1e-6);
    EXPECT_NEAR(body.rest_position.col(1).maxCoeff(), 1.70, 1e-6);
    EXPECT_TRUE(boundary_loops(body.triangle).empty());
}

TEST(ReadRiggedBody, SkinsAsAnIndependentSkinningDoes) {
    GltfScene scene = person();
    // Bind frames that are turned, as rigs' are, and shared influences.
    for (size_t j = 0; j < scene.node.size(); ++j) {
        Eigen::Affine3d turned(scene.skin[0].inverse_bind[j]);
        turned = Eigen::AngleAxisd(0.3 * static_cast<double>(j), Vector3d(1, 2, static_cast<double>(j)).normalized()) *
                 turned;
        scene.skin[0].inverse_bind[j] = turned.matrix();
    }
    for (size_t v = 0; v < scene.mesh[0].influence.size(); v += 3)
        scene.mesh[0].influence[v] = {{3, 0.25}, {6, 0.5}, {9, 0.25}};
    const Body body = read(scene).body;
    const Pose pose = wavy_pose(body);
    EXPECT_LT(
        (skin_positions(body, pose, SkinningMethod::linear) - independent_skinning(scene, pose)).cwiseAbs().maxCoeff(),
        1e-6);
}

TEST(ReadRiggedBody, IgnoresThePoseOfTheNodeTree) {
    const Body expected = read(person()).body;
    GltfScene scene = person();
    for (size_t j = 0; j < scene.node.size(); ++j) {
        const Eigen::Quaterniond q(Eigen::AngleAxisd(0.5 + static_cast<double>(j), Vector3d(1, 1, 0.3).normalized()));
        scene.node[j].rotation = q.coeffs();
    }
    expect_same_body(read(scene).body, expected, 1e-6);
}

TEST(ReadRiggedBody, BringsOtherAxesAndUnitsHome) {
    const Body expected = read(person()).body;
    const Matrix4d z_up = matrix(Eigen::Affine3d(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX())));
    const Matrix4d z_up_turned = z_up * matrix(Eigen::Affine3d(Eigen::AngleAxisd(M_PI, Vector3d::UnitY())));
    const Matrix4d x_up = matrix(Eigen::Affine3d(Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitZ())));
    const Matrix4d facing_left = matrix(Eigen::Affine3d(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY())));
    for (const Matrix4d& turn : {Matrix4d(Matrix4d::Identity()), z_up, z_up_turned, x_up, facing_left}) {
        for (const double unit : {1.0, 0.1, 0.01, 0.001, 0.0254, 0.3048}) {
            for (const bool rigid : {false, true}) {
                GltfScene scene = person();
                transform_bind(scene, turn * matrix(Eigen::Affine3d(Eigen::Scaling(1 / unit))));
                // Most files state bind transforms in their unit, without a scale; the node tree then tells nothing.
                for (Matrix4d& inverse : scene.skin[0].inverse_bind)
                    if (rigid) inverse = matrix(Eigen::Affine3d(Eigen::Scaling(1 / unit))) * inverse;
                const RiggedBody body = read(scene);
                expect_same_body(body.body, expected, 2e-6);
                const std::string remarks = testing::PrintToString(body.remarks);
                EXPECT_EQ(remarks.find("unit") != std::string::npos, unit != 1) << remarks;
                EXPECT_EQ(remarks.find("turned") != std::string::npos, !turn.isIdentity()) << remarks;
            }
        }
    }
}

TEST(ReadRiggedBody, DoesNotMoveTheBody) {
    GltfScene scene = person();
    transform_bind(scene, matrix(Eigen::Affine3d(Eigen::Translation3d(2, -1, 3))));
    const Body body = read(scene).body;
    EXPECT_NEAR(body.rest_position.col(1).minCoeff(), -1, 1e-6);
    EXPECT_NEAR(body.joint[0].bind(0, 3), 2, 1e-6);
}

TEST(ReadRiggedBody, HandlesATransformAboveTheArmature) {
    const Body expected = read(person()).body;
    // Stored in centimetres, z up, under an armature node that turns and shrinks: a converted file's usual shape.
    GltfScene scene = person();
    transform_bind(scene,
                   matrix(Eigen::Affine3d(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()) * Eigen::Scaling(100.0))));
    for (GltfNode& node : scene.node) {
        node.translation *= 100;
        if (node.parent >= 0) ++node.parent;
    }
    for (int& joint : scene.skin[0].joint) ++joint;
    scene.node[0].parent = 0;
    const double half = std::sqrt(0.5);
    scene.node.insert(scene.node.begin(), {"Armature", -1, {5, 6, 7}, {-half, 0, 0, half}, 0.01});
    expect_same_body(read(scene).body, expected, 2e-6);
}

TEST(ReadRiggedBody, OptionsOverrideWhatIsFoundOut) {
    GltfScene scene = person();
    RiggedBodyOptions options;
    options.metres_per_unit = 0.5;
    options.up = "z";
    const Body body = read(scene, options).body;
    EXPECT_NEAR(body.rest_position.col(2).maxCoeff() - body.rest_position.col(2).minCoeff(), 0.85, 1e-6);
    options.up = "up";
    expect_refused(scene, {"'up' is no up axis"}, options);
    options.up = "auto";
    options.metres_per_unit = -1;
    expect_refused(scene, {"metres_per_unit"}, options);
}

TEST(ReadRiggedBody, RefusesAHeightNoUnitExplains) {
    GltfScene scene = person();
    transform_bind(scene, matrix(Eigen::Affine3d(Eigen::Scaling(1e9))));
    scene.node[0].scale = 1e9;
    expect_refused(scene, {"units tall"});
}

TEST(ReadRiggedBody, JoinsMeshesBoundInDifferentSpaces) {
    const Body expected = read(person()).body;
    GltfScene scene = person();
    // The second half of the triangles moves to a mesh that is stored turned, scaled and moved.
    GltfMesh second = scene.mesh[0];
    const long half = second.triangle.rows() / 2;
    const Triangles first_triangles = second.triangle.topRows(half), last_triangles = second.triangle.bottomRows(half);
    scene.mesh[0].triangle = first_triangles;
    second.triangle = last_triangles;
    second.name = "rest";
    second.skin = 1;
    Eigen::Affine3d space =
        Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.8, Vector3d(1, 1, 1).normalized()) * Eigen::Scaling(3.0);
    GltfSkin skin = scene.skin[0];
    GltfScene other{{}, {skin}, {second}};
    transform_bind(other, space.matrix());
    scene.mesh.push_back(other.mesh[0]);
    scene.skin.push_back(other.skin[0]);
    const RiggedBody joined = read(scene);
    expect_same_body(joined.body, expected, 2e-6);
    EXPECT_THAT(joined.remarks, testing::ElementsAre(HasSubstr("welded"), HasSubstr("without a triangle")));
    // One of them alone is not the whole body, and is asked for by name.
    RiggedBodyOptions options;
    options.mesh = {"rest"};
    EXPECT_LT(read(scene, options).body.vertex_count(), expected.vertex_count());
    options.mesh = {"rset"};
    expect_refused(scene, {"no skinned mesh 'rset'"}, options);
}

TEST(ReadRiggedBody, WeldsSeamsBackToAClosedSurface) {
    const Body expected = read(person()).body;
    GltfScene scene = person();
    GltfMesh& mesh = scene.mesh[0];
    const GltfMesh whole = mesh;
    mesh.position.resize(whole.triangle.size(), 3);
    mesh.influence.clear();
    for (int corner = 0; corner < whole.triangle.size(); ++corner) {
        const int v = whole.triangle.data()[corner];
        mesh.position.row(corner) = whole.position.row(v);
        mesh.influence.push_back(whole.influence[v]);
        mesh.triangle.data()[corner] = corner;
    }
    const RiggedBody body = read(scene);
    EXPECT_EQ(body.body.vertex_count(), expected.vertex_count());
    EXPECT_TRUE(boundary_loops(body.body.triangle).empty());
    EXPECT_THAT(body.remarks, testing::ElementsAre(HasSubstr("welded")));
    // Vertices in one place that hang on different joints stay apart.
    mesh.influence[0] = {{0, 0.5}, {1, 0.5}};
    EXPECT_EQ(read(scene).body.vertex_count(), expected.vertex_count() + 1);
}

TEST(ReadRiggedBody, KeepsMoreThanFourInfluences) {
    GltfScene scene = person();
    scene.mesh[0].influence[7] = {{0, 0.3}, {1, 0.2}, {2, 0.2}, {3, 0.1}, {4, 0.1}, {5, 0.1}};
    const Body body = read(scene).body;
    EXPECT_EQ(body.weight.offset[8] - body.weight.offset[7], 6);
    const Pose pose = wavy_pose(body);
    EXPECT_LT(
        (skin_positions(body, pose, SkinningMethod::linear) - independent_skinning(scene, pose)).cwiseAbs().maxCoeff(),
        1e-6);
}

TEST(ReadRiggedBody, RefusesWeightsThatDoNotSumToOne) {
    GltfScene scene = person();
    scene.mesh[0].influence[11] = {{0, 0.5}, {1, 0.4}};
    expect_refused(scene, {"vertex 11 of mesh 'body'", "sum to 0.9"});
    scene.mesh[0].influence[11] = {{0, 0.0}};
    expect_refused(scene, {"vertex 11 of mesh 'body'", "no joint"});
    scene.mesh[0].influence[11] = {{0, 1.25}, {1, -0.25}};
    expect_refused(scene, {"vertex 11 of mesh 'body'", "negative"});
    // Integers may miss one by half a step for each influence, and no more.
    scene.mesh[0].weight_format = WeightFormat::unsigned_byte;
    scene.mesh[0].influence[11] = {{0, 0.2}, {1, 0.2}, {2, 0.2}, {3, 0.2}, {4, 0.1}, {5, 0.1}};
    EXPECT_NO_THROW(read(scene));
    scene.mesh[0].influence[11] = {{0, 0.5}, {1, 0.45}};
    expect_refused(scene, {"vertex 11 of mesh 'body'", "sum to 0.9"});
    scene.mesh[0].weight_format = WeightFormat::float32;
    scene.mesh[0].influence[11] = {{0, 0.6667}, {1, 0.3334}};
    const Body body = read(scene).body;
    EXPECT_NEAR(body.weight.value[body.weight.offset[11]] + body.weight.value[body.weight.offset[11] + 1], 1, 1e-15);
}

TEST(ReadRiggedBody, GivenRolesWinAndMustExist) {
    RiggedBodyOptions options;
    options.role[Role::spine] = "mixamorig:Hips";
    EXPECT_EQ(read(person(), options).body.role[Role::spine], 0);
    options.role[Role::spine] = "mixamorig:Spime";
    try {
        read(person(), options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("'mixamorig:Spime'"));
        EXPECT_THAT(error.what(), HasSubstr("role spine"));
        EXPECT_THAT(error.mend(), HasSubstr("mixamorig:Spine"));
    }
}

TEST(ReadRiggedBody, NamesTheRolesItDidNotFind) {
    HumanNames names = mixamo_names();
    names.neck = "";
    names.right[0] = "bone_7";
    const RiggedBody body = read(box_person(names));
    EXPECT_THAT(body.remarks, testing::Contains(HasSubstr("no joint was found for the roles neck, right_clavicle")));
}

TEST(ReadRiggedBody, MendsAnInsideOutSurfaceAndClosesAnOpenOne) {
    GltfScene scene = person();
    const Body expected = read(scene).body;
    Triangles& triangle = scene.mesh[0].triangle;
    triangle.col(0).swap(triangle.col(1));
    const RiggedBody turned = read(scene);
    EXPECT_THAT(turned.remarks, testing::ElementsAre(HasSubstr("inside out")));
    scene = person();
    scene.mesh[0].triangle.conservativeResize(scene.mesh[0].triangle.rows() - 2, 3);
    const RiggedBody closed = read(scene);
    EXPECT_THAT(closed.remarks, testing::ElementsAre(HasSubstr("1 holes of the surface were closed with 2 triangles")));
    EXPECT_TRUE(boundary_loops(closed.body.triangle).empty());
    EXPECT_EQ(closed.body.triangle.topRows(100), expected.triangle.topRows(100));
}

TEST(ReadRiggedBody, StripsScaleFromBindTransforms) {
    const Body expected = read(person()).body;
    GltfScene scene = person();
    for (Matrix4d& inverse : scene.skin[0].inverse_bind)
        inverse = matrix(Eigen::Affine3d(Eigen::Scaling(0.01))) * inverse;
    expect_same_body(read(scene).body, expected, 1e-6);
}

TEST(ReadRiggedBody, RefusesBindMatricesNobodyCanUse) {
    GltfScene scene = person();
    scene.skin[0].inverse_bind[4].col(1).setZero();
    expect_refused(scene, {"'mixamorig:Head'", "cannot be inverted"});
    scene = person();
    scene.skin[0].inverse_bind[4].col(1) *= -1;
    expect_refused(scene, {"'mixamorig:Head'", "mirrors"});
    scene = person();
    scene.skin[0].inverse_bind[4](0, 3) = std::nan("");
    expect_refused(scene, {"'mixamorig:Head'", "not finite"});
}

TEST(ReadRiggedBody, RealBodiesKeepTheirVerticesAndRoles) {
    for (const char* name : {"mh_female_cmu", "mh_male_default"}) {
        const std::string path = std::string(TOILE_SHARED_DATA) + "/bodies/" + name + ".glb";
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data: " << path;
        const RiggedBody body = read_rigged_body(path);
        EXPECT_EQ(body.body.vertex_count(), 13380);
        EXPECT_THAT(body.remarks, testing::IsEmpty());
        EXPECT_TRUE(body.body.role.missing().empty());
        EXPECT_TRUE(boundary_loops(body.body.triangle).empty());
    }
}

}  // namespace
}  // namespace toile::skin

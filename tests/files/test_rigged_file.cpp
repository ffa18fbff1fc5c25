#include <gmock/gmock.h>

#include <limits>

#include "cloth/error.h"
#include "files/rigged_file.h"
#include "tests/support/rigged_gltf.h"

namespace toile::files {
namespace {

using testing::HasSubstr;
using namespace toile::testing_support;

GltfScene person() {
    return box_person(mixamo_names());
}

void expect_refused(const std::string& text, const std::string& word, const std::string& name = "body.gltf") {
    const std::string path = write_test_file(name, text);
    try {
        read_rigged_file(path);
        ADD_FAILURE() << "accepted: " << word;
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(word));
        EXPECT_EQ(error.where(), path);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

double weight_sum(const RiggedMesh& mesh, int v) {
    double sum = 0;
    for (int i = mesh.influence_offset[v]; i < mesh.influence_offset[v + 1]; ++i) sum += mesh.influence_value[i];
    return sum;
}

TEST(ReadRiggedFile, ReadsGltfAsStored) {
    const GltfScene scene = person();
    const RiggedFile file = read_rigged_file(write_test_file("body.gltf", gltf_text(scene)));
    ASSERT_EQ(file.mesh.size(), 1u);
    const RiggedMesh& mesh = file.mesh[0];
    EXPECT_EQ(mesh.name, "body");
    EXPECT_LT((mesh.position - scene.mesh[0].position).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(mesh.triangle, scene.mesh[0].triangle);
    ASSERT_EQ(mesh.bone.size(), 19u);
    for (size_t b = 0; b < mesh.bone.size(); ++b) {
        EXPECT_EQ(mesh.bone[b].name, scene.node[b].name);
        EXPECT_EQ(file.node[mesh.bone[b].node].name, scene.node[b].name);
        EXPECT_TRUE(mesh.bone[b].offset.isApprox(scene.skin[0].inverse_bind[b], 1e-6));
    }
    EXPECT_EQ(file.metres_per_unit, 1);
    EXPECT_EQ(file.up, "y");
}

TEST(ReadRiggedFile, ReadsWeightsOfEveryNumberFormat) {
    for (const WeightFormat format :
         {WeightFormat::float32, WeightFormat::unsigned_byte, WeightFormat::unsigned_short}) {
        GltfScene scene = person();
        scene.mesh[0].weight_format = format;
        scene.mesh[0].influence[5] = {{0, 0.2}, {1, 0.2}, {2, 0.2}, {3, 0.2}, {4, 0.1}, {5, 0.1}};
        const RiggedFile file = read_rigged_file(write_test_file("body.gltf", gltf_text(scene)));
        const RiggedMesh& mesh = file.mesh[0];
        EXPECT_EQ(mesh.influence_offset[6] - mesh.influence_offset[5], 6);
        for (int v = 0; v < mesh.position.rows(); ++v) EXPECT_NEAR(weight_sum(mesh, v), 1, 0.01);
        EXPECT_NEAR(mesh.influence_value[mesh.influence_offset[5]], 0.2, 0.002);
    }
}

TEST(ReadRiggedFile, AcceptsNodesThatShareAName) {
    GltfScene scene = person();
    for (GltfNode& node : scene.node) node.name = "bone";
    EXPECT_EQ(read_rigged_file(write_test_file("body.gltf", gltf_text(scene))).mesh[0].bone.size(), 19u);
    for (GltfNode& node : scene.node) node.name = "";
    EXPECT_EQ(read_rigged_file(write_test_file("body.gltf", gltf_text(scene))).node[3].name, "node_3");
}

TEST(ReadRiggedFile, RefusesDamagedGltf) {
    const std::string good = gltf_text(person());
    expect_refused(good.substr(0, good.size() / 2), "cannot read the glTF file");
    expect_refused("", "the file is empty");
    expect_refused("not glTF at all", "no glTF");
    expect_refused("{}", "cannot read the glTF file");
    expect_refused("{\"asset\":{\"version\":\"2.0\"}}", "no faces");
    expect_refused(std::string("glTF\x02\0\0\0\xff\xff\xff\xff{{{{{{{{{{{{", 24), "cannot read the glTF file",
                   "body.glb");
    expect_refused(replaced(good, "\"inverseBindMatrices\"", "\"nothing\""), "no inverse bind matrices");
    expect_refused(replaced(good, ",\"skin\":0", ""), "no mesh of the file has a skin");
    expect_refused(replaced(good, ",\"skin\":0", ",\"skin\":7"), "skin that is not there");
    expect_refused(replaced(good, "\"mesh\":0", "\"mesh\":7"), "mesh that is not there");
    expect_refused(replaced(good, "\"POSITION\":0", "\"POSITION\":99"), "accessor 99");
    expect_refused(replaced(good, "\"JOINTS_0\"", "\"JOINTS_9\""), "weights without joints");
    expect_refused(replaced(good, "\"children\":[1", "\"children\":[0"), "");
    expect_refused(replaced(good, "\"children\":[1", "\"children\":[99"), "child that is not there");
    expect_refused(replaced(good, "\"count\":152", "\"count\":153"), "points outside its buffer");
    expect_refused(replaced(good, "\"count\":152", "\"count\":18446744073709551615"), "");
    expect_refused(replaced(good, "\"asset\"", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\""),
                   "KHR_draco_mesh_compression");
}

TEST(ReadRiggedFile, RefusesDefectsInTheNumbers) {
    GltfScene scene = person();
    scene.mesh[0].position(17, 1) = std::numeric_limits<double>::quiet_NaN();
    expect_refused(gltf_text(scene), "vertex 17 of mesh 'body' is not finite");
    scene = person();
    scene.mesh[0].triangle(3, 1) = 152;
    expect_refused(gltf_text(scene), "vertex 152 of 152");
    scene = person();
    scene.mesh[0].influence[9] = {{19, 1.0}};
    expect_refused(gltf_text(scene), "vertex 9 of mesh 'body' hangs on joint 19 of a skin of 19");
    scene = person();
    scene.mesh[0].influence[9] = {{3, std::numeric_limits<double>::infinity()}};
    expect_refused(gltf_text(scene), "weight of vertex 9");
    scene = person();
    scene.skin[0].inverse_bind[2](1, 3) = std::numeric_limits<double>::quiet_NaN();
    expect_refused(gltf_text(scene), "bind matrix of joint 'mixamorig:Spine2' is not finite");
    scene = person();
    scene.mesh[0].triangle.resize(0, 3);
    expect_refused(gltf_text(scene), "no faces");
}

/// A Collada file of one triangle on two joints; z up, in centimetres.
std::string collada() {
    return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="g" name="g"><mesh>
  <source id="gp"><float_array id="gpa" count="9">0 0 0 100 0 0 0 0 150</float_array><technique_common>
   <accessor source="#gpa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="gv"><input semantic="POSITION" source="#gp"/></vertices>
  <triangles count="1"><input semantic="VERTEX" source="#gv" offset="0"/><p>0 1 2</p></triangles>
 </mesh></geometry></library_geometries>
 <library_controllers><controller id="c"><skin source="#g">
  <bind_shape_matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
  <source id="cj"><Name_array id="cja" count="2">low high</Name_array><technique_common>
   <accessor source="#cja" count="2" stride="1"><param name="JOINT" type="name"/></accessor></technique_common></source>
  <source id="cb"><float_array id="cba" count="32">1 0 0 0 0 1 0 0 0 0 1 -10 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1 -90 0 0 0 1</float_array><technique_common>
   <accessor source="#cba" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
  <source id="cw"><float_array id="cwa" count="2">0.75 0.25</float_array><technique_common>
   <accessor source="#cwa" count="2" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
  <joints><input semantic="JOINT" source="#cj"/><input semantic="INV_BIND_MATRIX" source="#cb"/></joints>
  <vertex_weights count="3"><input semantic="JOINT" source="#cj" offset="0"/><input semantic="WEIGHT" source="#cw" offset="1"/>
   <vcount>2 2 2</vcount><v>0 0 1 1 0 0 1 1 1 0 0 1</v></vertex_weights>
 </skin></controller></library_controllers>
 <library_visual_scenes><visual_scene id="s"><node id="low" sid="low" name="low" type="JOINT"><translate>0 0 33</translate>
   <node id="high" sid="high" name="high" type="JOINT"><translate>0 0 80</translate></node></node>
  <node id="n" name="n"><instance_controller url="#c"><skeleton>#low</skeleton></instance_controller></node>
 </visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";
}

TEST(ReadRiggedFile, ReadsCollada) {
    const RiggedFile file = read_rigged_file(write_test_file("body.dae", collada()));
    ASSERT_EQ(file.mesh.size(), 1u);
    const RiggedMesh& mesh = file.mesh[0];
    ASSERT_EQ(mesh.bone.size(), 2u);
    EXPECT_EQ(mesh.position.rows(), 3);
    for (int v = 0; v < 3; ++v) EXPECT_NEAR(weight_sum(mesh, v), 1, 1e-6);
    for (const RiggedBone& bone : mesh.bone) {
        EXPECT_NEAR(bone.offset(2, 3), bone.name == "low" ? -10 : -90, 1e-5);
        EXPECT_NEAR(bone.offset(0, 3), 5, 1e-5);
        EXPECT_EQ(file.node[bone.node].name, bone.name);
    }
    // The format's unit and up axis are in the root's transform.
    EXPECT_NEAR(file.node[0].local.col(0).norm(), 0.01, 1e-6);
    EXPECT_NEAR(file.node[0].local(1, 2), 0.01, 1e-6);
}

TEST(ReadRiggedFile, RefusesDamagedCollada) {
    const std::string good = collada();
    expect_refused(good.substr(0, good.size() / 2), "cannot read", "body.dae");
    expect_refused(replaced(good, "count=\"9\">0 0 0", "count=\"9\">0 nan 0"), "", "body.dae");
    expect_refused(replaced(good, "<p>0 1 2</p>", "<p>0 1 7</p>"), "", "body.dae");
    expect_refused(replaced(good, "<instance_controller url=\"#c\"><skeleton>#low</skeleton></instance_controller>",
                            "<instance_geometry url=\"#g\"/>"),
                   "no mesh of the file has a skin", "body.dae");
}

TEST(ReadScene, TakesFilesWithoutASkin) {
    const RiggedFile file = read_scene(write_test_file("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    EXPECT_EQ(file.mesh[0].position.rows(), 3);
    EXPECT_TRUE(file.mesh[0].bone.empty());
}

}  // namespace
}  // namespace toile::files

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "files/rigged_file.h"
#include "tests/support/rigged_gltf.h"

namespace toile::files {
namespace {

using testing::HasSubstr;
using toile::testing_support::gltf_text;
using toile::testing_support::GltfMesh;
using toile::testing_support::GltfScene;
using toile::testing_support::write_test_file;

/// An irregular tetrahedron, its vertices in an order that no face list begins with.
NamedMesh tetrahedron() {
    NamedMesh mesh{"a piece", Triangles(4, 3), Positions(4, 3)};
    mesh.position << 1.0 / 3, 1e-7, -2, 1.234567890123, 0, 0, 0.1, 1, 0, 0, 0.2, 1;
    mesh.triangle << 3, 2, 1, 0, 1, 2, 0, 2, 3, 0, 3, 1;
    return mesh;
}

void expect_error(const std::string& path, const std::string& what, const std::string& where) {
    try {
        read_mesh(path);
        ADD_FAILURE() << "accepted " << path;
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(what));
        EXPECT_THAT(error.where(), testing::EndsWith(where));
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

void expect_obj_error(const std::string& text, const std::string& what, const std::string& where) {
    expect_error(write_test_file("garment.obj", text), what, where);
}

TEST(WriteMesh, KeepsOrderAndPositions) {
    const NamedMesh mesh = tetrahedron();
    for (const char* name : {"mesh.ply", "mesh.glb"}) {  // assimp reorders OBJ; its text is checked below
        const std::string path = write_test_file(name, "");
        write_mesh(path, mesh.triangle, mesh.position);
        const RiggedFile back = read_scene(path);
        ASSERT_EQ(back.mesh.size(), 1u);
        EXPECT_EQ(back.mesh[0].triangle, mesh.triangle) << name;
        EXPECT_LT((back.mesh[0].position - mesh.position).cwiseAbs().maxCoeff(), 1e-6) << name;
    }
}

TEST(WriteMesh, ObjHoldsPositionsToTwelveDecimals) {
    const NamedMesh mesh = tetrahedron();
    const std::string path = write_test_file("mesh.obj", "");
    write_mesh(path, mesh.triangle, mesh.position);
    std::ifstream file(path);
    std::string word;
    int v = 0, f = 0;
    while (file >> word) {
        double x, y, z;
        if (word == "v") {
            file >> x >> y >> z;
            EXPECT_LT((Eigen::RowVector3d(x, y, z) - mesh.position.row(v++)).norm(), 1e-11);
        } else if (word == "f") {
            file >> x >> y >> z;
            EXPECT_EQ(Eigen::RowVector3i(int(x) - 1, int(y) - 1, int(z) - 1), mesh.triangle.row(f++).eval());
        }
    }
    EXPECT_EQ(v, 4);
    EXPECT_EQ(f, 4);
}

TEST(WriteMesh, PlyHoldsFloat64) {
    const NamedMesh mesh = tetrahedron();
    const std::string path = write_test_file("mesh.ply", "");
    write_mesh(path, mesh.triangle, mesh.position);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const size_t start = bytes.find("end_header\n") + 11;
    Positions stored(4, 3);
    std::memcpy(stored.data(), bytes.data() + start, sizeof(double) * 12);
    EXPECT_EQ(stored, mesh.position);
}

TEST(WriteMeshes, KeepsPiecesAndNamesInGlb) {
    NamedMesh first = tetrahedron(), second = tetrahedron();
    second.name = "cloth \"B\"";
    second.position.array() += 3;
    second.color = {1, 0, 0};
    const std::string path = write_test_file("two.glb", "");
    write_meshes(path, {first, second});
    const MeshData data = read_mesh(path);
    EXPECT_EQ(data.part_name, (std::vector<std::string>{"a piece", "cloth \"B\""}));
    EXPECT_EQ(data.position.rows(), 8);
    EXPECT_EQ(data.part, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1}));
    for (const char* ending : {"two.obj", "two.ply"}) {
        const std::string other = write_test_file(ending, "");
        write_meshes(other, {first, second});
        EXPECT_EQ(read_mesh(other).triangle.rows(), 8);
        EXPECT_EQ(read_mesh(other).position.rows(), 8);
    }
}

TEST(WriteMesh, RefusesWhatNoFileHolds) {
    NamedMesh mesh = tetrahedron();
    EXPECT_THROW(write_mesh(write_test_file("mesh.stl", ""), mesh.triangle, mesh.position), Error);
    EXPECT_THROW(write_mesh("/nonexistent/folder/mesh.obj", mesh.triangle, mesh.position), Error);
    const std::string path = write_test_file("mesh.glb", "untouched");
    mesh.triangle(0, 0) = 4;
    EXPECT_THROW(write_mesh(path, mesh.triangle, mesh.position), Error);
    mesh.triangle(0, 0) = 3;
    mesh.position(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(write_mesh(path, mesh.triangle, mesh.position), Error);
    EXPECT_THROW(write_meshes(path, {}), Error);
    EXPECT_EQ(std::filesystem::file_size(path), 9u);
}

TEST(WriteMesh, LeavesNothingBehindWhenTheDiskIsFull) {
    NamedMesh mesh = tetrahedron();
    mesh.position = Positions::Random(2000, 3);
    const std::string path = write_test_file("full.obj", "before");
    rlimit before;
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{10'000, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    bool refused = false;
    try {
        write_mesh(path, mesh.triangle, mesh.position);
    } catch (const Error& error) {
        refused = error.where() == path;
    }
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_TRUE(refused);
    EXPECT_EQ(std::filesystem::file_size(path), 6u);
    int files = 0;
    for ([[maybe_unused]] const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(path).parent_path()))
        ++files;
    EXPECT_EQ(files, 1);
}

TEST(ReadMesh, JoinsObjCornersAndKeepsTextureSeams) {
    const MeshData data = read_mesh(write_test_file("square.obj",
                                                    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                                    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 5\n"
                                                    "g left\nf 1/1 2/2 3/3\ng right\nf 1/1 3/3 4/4\n"));
    EXPECT_EQ(data.position.rows(), 4);
    EXPECT_EQ(data.texture.rows(), 4);
    EXPECT_EQ(data.part_name, (std::vector<std::string>{"left", "right"}));
    const MeshData seam = read_mesh(write_test_file("seam.obj",
                                                    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                                    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 5\n"
                                                    "f 1/1 2/2 3/3\nf 1/1 3/5 4/4\n"));
    EXPECT_EQ(seam.position.rows(), 5);
    const MeshData plain =
        read_mesh(write_test_file("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n"));
    EXPECT_EQ(plain.position.rows(), 4);
    EXPECT_EQ(plain.triangle.rows(), 2);
    EXPECT_EQ(plain.texture.rows(), 0);
}

TEST(ReadMesh, NamesTheLineOfAnObjDefect) {
    const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(read_mesh(write_test_file("good.obj", good + "f 1 2 3\n")).triangle.rows(), 1);
    expect_obj_error("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not finite", "garment.obj:2");
    expect_obj_error("v 0 0 0\nv 1 0 0\nv 0 -inf 0\nf 1 2 3\n", "not finite", "garment.obj:3");
    expect_obj_error("v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", "needs 3 coordinates", "garment.obj:3");
    expect_obj_error("v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", "'x' is no coordinate", "garment.obj:2");
    expect_obj_error(good + "f 1 2 4\n", "vertex 4 of 3", "garment.obj:4");
    expect_obj_error(good + "f 0 1 2\n", "vertex 0 of 3", "garment.obj:4");
    expect_obj_error(good + "f 1 2 three\n", "'three' is no corner", "garment.obj:4");
    expect_obj_error(good + "vt 0 0\nf 1/1 2/1 3/2\n", "texture coordinate 2 of 1", "garment.obj:5");
    expect_obj_error(good + "v 9 9 9\nf 1 2 3\n", "vertex 4 belongs to no face", "garment.obj:4");
    expect_obj_error(good, "no faces", "garment.obj");
}

TEST(ReadMesh, RefusesFilesItCannotRead) {
    expect_error("/nonexistent/mesh.obj", "does not exist", "mesh.obj");
    expect_error(testing::TempDir(), "folder", "");
    for (const char* name : {"a.obj", "a.ply", "a.glb", "a.gltf", "a.fbx", "a.dae", "a.xyz"}) {
        expect_error(write_test_file(name, ""), "empty", name);
        expect_error(write_test_file(name, std::string("\x8f\x01\x02garbage\xff\x00\x7f{[<", 16)), "", name);
    }
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_EQ(read_mesh(write_test_file("good.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).triangle.rows(), 1);
    expect_error(write_test_file("cut.ply", ply + "0 0 0\n1 0 0\n"), "", "cut.ply");
    expect_error(write_test_file("word.ply", "ply\nprpoperty float x\n" + ply.substr(4)), "none of the format's",
                 "word.ply");
    expect_error(write_test_file("header.ply", ply.substr(0, ply.size() - 11)), "has no end", "header.ply");
    expect_error(write_test_file("nan.ply", ply + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), "not finite", "nan.ply");
    expect_error(write_test_file("index.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), "", "index.ply");
}

TEST(ReadMesh, RefusesGltfThatWouldTakeAllStackOrMemory) {
    const std::string start = "{\"asset\":{\"version\":\"2.0\"},";
    const std::string nested = start + "\"extras\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}";
    expect_error(write_test_file("nested.gltf", nested), "", "nested.gltf");
    const std::string large = start +
                              "\"accessors\":[{\"componentType\":5126,\"type\":\"VEC3\",\"count\":29000000,\"sparse\":"
                              "{\"count\":0,\"indices\":{\"bufferView\":0,\"componentType\":5125},"
                              "\"values\":{\"bufferView\":0}}}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                              "{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}";
    expect_error(write_test_file("large.gltf", large), "too large to have no buffer", "large.gltf");
}

TEST(ReadMesh, AppliesNodeTransformsOfUnskinnedGltf) {
    const NamedMesh piece = tetrahedron();
    GltfMesh mesh{"piece", piece.position, PlanePositions::Constant(4, 2, 0.25), piece.triangle, {}};
    const std::string text = gltf_text(GltfScene{{}, {}, {mesh}});
    const size_t at = text.find("\"mesh\":0");
    const MeshData data = read_mesh(write_test_file(
        "moved.gltf", text.substr(0, at) + "\"translation\":[1,2,3],\"scale\":[2,2,2]," + text.substr(at)));
    const Positions expected = (2 * piece.position).rowwise() + Eigen::RowVector3d(1, 2, 3);
    EXPECT_LT((data.position - expected).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_NEAR(data.texture(0, 1), 0.75, 1e-6);  // glTF's v runs downwards
    // A vertex without a face stays, for the caller to see.
    mesh.triangle.conservativeResize(1, 3);
    EXPECT_EQ(read_mesh(write_test_file("loose.gltf", gltf_text(GltfScene{{}, {}, {mesh}}))).position.rows(), 4);
}

}  // namespace
}  // namespace toile::files

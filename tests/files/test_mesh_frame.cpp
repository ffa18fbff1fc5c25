#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "files/mesh_frame.h"

namespace toile::files {
namespace {

using ::testing::HasSubstr;

class MeshFrameFile : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("toile_mesh_frame_" + std::to_string(::getpid()) + "_" +
                                                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }
    std::string refusal(const std::string& file) const {
        try {
            read_mesh_frame(file);
        } catch (const Error& error) {
            return error.where() + " " + error.what();
        }
        return "accepted";
    }
    std::filesystem::path folder_;
};

TEST_F(MeshFrameFile, KeepsOrderCountAndBitsOfVertices) {
    // The faces use the vertices from the end, two of which coincide, and one is in no face.
    Positions position(5, 3);
    position << 1.0 / 3, 0, 0, 7, 8, 9, 0.1, 1, 0, 0, 0.25, 1e-9, 0, 0.25, 1e-9;
    Triangles triangle(2, 3);
    triangle << 4, 2, 0, 3, 2, 0;
    write_mesh(path("a.ply"), triangle, position);
    const MeshFrame ply = read_mesh_frame(path("a.ply"));
    EXPECT_EQ(ply.position, position);
    EXPECT_EQ(ply.triangle, triangle);
    write_mesh(path("a.obj"), triangle, position);
    const MeshFrame obj = read_mesh_frame(path("a.obj"));
    EXPECT_LT((obj.position - position).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(obj.triangle, triangle);
}

TEST_F(MeshFrameFile, ReadsWhatOthersWrite) {
    const MeshFrame obj = read_mesh_frame(
        write("b.OBJ",
              "mtllib x.mtl\no part\nv 0 0 0 0.5 0.5 0.5\r\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\nv 0 1 0\n"
              "f 1/1/1 2/1/1 3//1 4\nf -1 -2 -3\n"));
    Triangles expected(3, 3);
    expected << 0, 1, 2, 0, 2, 3, 3, 2, 1;
    EXPECT_EQ(obj.triangle, expected);
    EXPECT_EQ(obj.position(1, 0), 1);
    const MeshFrame ply = read_mesh_frame(write(
        "b.ply",
        "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar int vertex_index\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n"
        "4 0 1 2 3\n"));
    EXPECT_EQ(ply.triangle, expected.topRows(2));
    EXPECT_EQ(ply.position(3, 1), 1);
}

TEST_F(MeshFrameFile, PassesOverTexture) {
    NamedMesh mesh{"cloth", Triangles(1, 3), Positions(3, 3)};
    mesh.triangle << 0, 1, 2;
    mesh.position << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    mesh.texture = mesh.position.leftCols<2>();
    mesh.texture_triangle = mesh.triangle;
    for (const char* name : {"t.obj", "t.ply"}) {
        write_meshes(path(name), {mesh});
        EXPECT_EQ(read_mesh_frame(path(name)).position, mesh.position) << name;
    }
}

TEST_F(MeshFrameFile, RefusesDamage) {
    EXPECT_THAT(refusal(path("absent.obj")), HasSubstr("does not exist"));
    EXPECT_THAT(refusal(write("a.stl", "solid")), HasSubstr("neither .obj nor .ply"));
    EXPECT_THAT(refusal(write("empty.ply", "")), HasSubstr("empty"));
    EXPECT_THAT(refusal(write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n")), HasSubstr("a.obj:3"));
    EXPECT_THAT(refusal(write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")), HasSubstr("a.obj:4"));
    EXPECT_THAT(refusal(write("a.obj", "v 0 0 0\n")), HasSubstr("no faces"));
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
        "double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_EQ(refusal(write("a.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")), "accepted");
    EXPECT_THAT(refusal(write("a.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")), HasSubstr("vertex 3 of 3"));
    EXPECT_THAT(refusal(write("a.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n")), HasSubstr("a.ply"));
    EXPECT_THAT(refusal(write("a.ply", header + "0 0 0\n1 0 0\n")), HasSubstr("a.ply"));
    EXPECT_THAT(refusal(write("a.ply", header.substr(0, 60))), HasSubstr("a.ply"));
    EXPECT_THAT(refusal(write("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")), HasSubstr("a.ply"));
    // Binary, not a number.
    Positions position = Positions::Identity(3, 3);
    Triangles triangle(1, 3);
    triangle << 0, 1, 2;
    write_mesh(path("n.ply"), triangle, position);
    std::fstream file(path("n.ply"), std::ios::binary | std::ios::in | std::ios::out);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    file.seekp(static_cast<long>(std::filesystem::file_size(path("n.ply"))) - 13 - 24);
    file.write(reinterpret_cast<const char*>(&nan), sizeof nan);
    file.close();
    EXPECT_THAT(refusal(path("n.ply")), HasSubstr("vertex 2 is not finite"));
}

TEST_F(MeshFrameFile, OutlivesFilesThatLie) {
    const std::string list =
        "property double x\nproperty double y\nproperty double z\nelement face 1\n"
        "property list uint int vertex_indices\nend_header\n";
    for (const char* count : {"4000000000", "-1", "99999999999999999999"})
        EXPECT_THAT(refusal(write("lie.ply", std::string("ply\nformat binary_little_endian 1.0\nelement vertex ") +
                                                 count + "\n" + list + "abc")),
                    HasSubstr("lie.ply"));
    std::string face = "ply\nformat binary_little_endian 1.0\nelement vertex 0\n" + list;
    face += std::string("\xff\xff\xff\xff", 4);
    EXPECT_THAT(refusal(write("list.ply", face)), HasSubstr("list.ply"));
}

}  // namespace
}  // namespace toile::files

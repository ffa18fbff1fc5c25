#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/gltf_writer.h"
#include "files/new_folder.h"
#include "files/npz_file.h"
#include "files/point_cache.h"
#include "files/xdmf_file.h"

namespace toile::files {
namespace {

namespace fs = std::filesystem;

class ExportFiles : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string bytes(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    fs::path folder_ = fs::temp_directory_path() / ("toile_export_files_" + std::to_string(getpid()));
};

TEST_F(ExportFiles, NpzHoldsArraysThatStartAtAMultipleOf64InTheirFile) {
    {
        NpzWriter file(path("a.npz"));
        file.add("n", std::vector<int32_t>{1, 2, 3, 4, 5, 6}, {2, 3});
        file.add_strings("s", {"a", "bcd"});
        file.commit();
    }
    const std::string zip = bytes("a.npz");
    ASSERT_EQ(zip.substr(0, 4), "PK\x03\x04");
    const size_t npy = zip.find("\x93NUMPY");
    EXPECT_THAT(zip.substr(npy, 128),
                testing::HasSubstr("{'descr': '<i4', 'fortran_order': False, 'shape': (2,3,), }"));
    const size_t header = 10 + static_cast<unsigned char>(zip[npy + 8]);
    EXPECT_EQ(header % 64, 0u);
    int32_t value[6];
    std::memcpy(value, &zip[npy + header], sizeof value);
    EXPECT_THAT(value, testing::ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(zip, testing::HasSubstr(std::string("a\0\0bcd", 6)));
}

TEST_F(ExportFiles, NpzWithoutACommitLeavesNothingAndAnIncompleteArrayIsOurMistake) {
    {
        NpzWriter file(path("a.npz"));
        file.begin("n", "<f4", {2});
        const float one = 1;
        file.append(&one, 4);
        EXPECT_THROW(file.commit(), std::logic_error);
        EXPECT_THROW(file.append(&one, 8), std::logic_error);
    }
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(ExportFiles, PointCacheHasItsHeader) {
    PointCacheWriter file(path("a.pc2"), 2, 1);
    Positions position(2, 3);
    position << 1, 2, 3, 4, 5, 6;
    file.append(position);
    EXPECT_THROW(file.append(position), std::logic_error);
    EXPECT_FALSE(fs::exists(path("a.pc2")));
}

TEST_F(ExportFiles, PointCacheHoldsFloats) {
    PointCacheWriter file(path("a.pc2"), 2, 1);
    Positions position(2, 3);
    position << 1, 2, 3, 4, 5, 6;
    file.append(position);
    file.commit();
    const std::string cache = bytes("a.pc2");
    ASSERT_EQ(cache.size(), 32u + 24u);
    EXPECT_EQ(cache.substr(0, 12), std::string("POINTCACHE2\0", 12));
    int32_t whole[5];
    std::memcpy(whole, &cache[12], sizeof whole);
    EXPECT_EQ(whole[0], 1);
    EXPECT_EQ(whole[1], 2);
    EXPECT_EQ(whole[4], 1);
    float last;
    std::memcpy(&last, &cache[52], 4);
    EXPECT_EQ(last, 6.0f);
}

TEST_F(ExportFiles, FolderAppearsWithTheCommit) {
    fs::create_directories(path("empty"));
    NewFolder folder(path("empty/"));
    std::ofstream(folder.file("a")) << "1";
    EXPECT_TRUE(fs::is_empty(path("empty")));
    EXPECT_THROW(NewFolder(path("empty")), Error) << "one at a time";
    folder.commit();
    EXPECT_EQ(bytes("empty/a"), "1");
    EXPECT_FALSE(fs::exists(path("empty.partial")));
    EXPECT_THROW(NewFolder(path("empty")), Error) << "it holds something";
    EXPECT_THROW(NewFolder(path("none/a")), Error);
    { NewFolder(path("b")); }
    EXPECT_FALSE(fs::exists(path("b"))) << "not committed";
}

TEST_F(ExportFiles, GltfThatWouldBeTooLargeIsRefusedBeforeItIsMade) {
    NamedMesh mesh{"cloth", Triangles(1, 3), Positions::Random(100000, 3)};
    mesh.triangle << 0, 1, 2;
    GltfWriter file(path("a.glb"), 1000, 1.0);
    try {
        file.begin_morphing_mesh(mesh);
        ADD_FAILURE() << "accepted 2.4 GB";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("would take 2.4 GB"));
        EXPECT_THAT(error.mend(), testing::HasSubstr("--pose"));
    }
}

TEST_F(ExportFiles, GltfNamesMayHoldAnyBytes) {
    NamedMesh mesh{"caf\xe9", Triangles(1, 3), Positions(3, 3)};
    mesh.triangle << 0, 1, 2;
    mesh.position << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    GltfWriter file(path("a.glb"));
    file.add_mesh(mesh);
    file.commit();
    EXPECT_THAT(bytes("a.glb"), testing::HasSubstr("\"caf?\""));
}

TEST_F(ExportFiles, XdmfEscapesNames) {
    const XdmfMesh mesh{"cloth", {"a&b.h5", "/mesh/triangle"}, {"a&b.h5", "/samples/cloth"}, {}, 3, 4, 5};
    XdmfWriter file(path("a.xdmf"));
    file.begin_sample("pose_7", 7);
    file.add_mesh(mesh, 2, {{"status", 1}});
    file.end_sample();
    file.commit();
    const std::string text = bytes("a.xdmf");
    for (const char* expected : {"a&amp;b.h5:/samples/cloth", ">2 0 0 1 1 1 1 4 3<", "Dimensions=\"5 4 3\"", "</Xdmf>"})
        EXPECT_THAT(text, testing::HasSubstr(expected));
}

}  // namespace
}  // namespace toile::files

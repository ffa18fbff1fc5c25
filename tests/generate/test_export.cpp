#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "generate/export.h"
#include "generate/stored_body.h"
#include "skin/skinning.h"
#include "tests/generate/tiny_dataset.h"
#include "tests/support/file_size_limit.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ExportTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / ("toile_export_" + std::string(info->name()) + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    ExportOptions options(ExportFormat format, const std::string& out) const {
        ExportOptions options;
        options.dataset = path("dataset.h5");
        options.out = path(out);
        options.format = format;
        return options;
    }
    std::vector<std::string> names() const {
        std::vector<std::string> name;
        for (const auto& entry : fs::recursive_directory_iterator(folder_))
            name.push_back(fs::relative(entry.path(), folder_).string());
        std::sort(name.begin(), name.end());
        return name;
    }
    void expect_refused(const ExportOptions& options, const std::string& what) {
        const auto before = names();
        try {
            export_dataset(options);
            ADD_FAILURE() << "accepted, not refused for: " << what;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr(what));
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
        EXPECT_EQ(names(), before);
    }
    fs::path folder_;
};

/// Slot 1 failed, slot 3 failed and is not finite.
TinyDataset two_failed() {
    TinyDataset tiny;
    tiny.change_sample = [](int slot, files::SampleRecord& sample) {
        if (slot % 2 == 1) sample.status = 1;
        if (slot == 3) sample.cloth(0, 0) = std::numeric_limits<double>::quiet_NaN();
    };
    return tiny;
}

Positions positions(const aiVector3D* first, unsigned count) {
    Positions position(count, 3);
    for (unsigned v = 0; v < count; ++v) position.row(v) << first[v].x, first[v].y, first[v].z;
    return position;
}

Eigen::Matrix4d matrix(const aiMatrix4x4& m) {
    Eigen::Matrix4d out;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned k = 0; k < 4; ++k) out(i, k) = m[i][k];
    return out;
}

/// What assimp makes of an exported .glb, evaluated at key k of its one animation.
struct Played {
    Played(const std::string& path) : scene(importer.ReadFile(path, aiProcess_ValidateDataStructure)) {}

    const aiMesh& mesh(const std::string& name) const {
        for (unsigned i = 0; i < scene->mNumMeshes; ++i)
            if (scene->mMeshes[i]->mName.C_Str() == name) return *scene->mMeshes[i];
        throw std::runtime_error("no mesh " + name);
    }
    Positions cloth(unsigned key) const {
        const aiMesh& cloth = mesh("cloth");
        const Positions rest = positions(cloth.mVertices, cloth.mNumVertices);
        Positions position = rest;
        const aiMeshMorphKey& weights = scene->mAnimations[0]->mMorphMeshChannels[0]->mKeys[key];
        for (unsigned i = 0; i < weights.mNumValuesAndWeights; ++i)
            position += weights.mWeights[i] *
                        (positions(cloth.mAnimMeshes[weights.mValues[i]]->mVertices, cloth.mNumVertices) - rest);
        return position;
    }
    Eigen::Matrix4d world(const aiNode* node, unsigned key) const {
        Eigen::Matrix4d local = matrix(node->mTransformation);
        for (unsigned i = 0; i < scene->mAnimations[0]->mNumChannels; ++i) {
            const aiNodeAnim& channel = *scene->mAnimations[0]->mChannels[i];
            if (channel.mNodeName != node->mName) continue;
            const aiQuaternion q = channel.mRotationKeys[key].mValue;
            local.topLeftCorner<3, 3>() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
        }
        return node->mParent ? (world(node->mParent, key) * local).eval() : local;
    }
    Positions body(unsigned key) const {
        const aiMesh& body = mesh("body");
        Positions posed = Positions::Zero(body.mNumVertices, 3);
        for (unsigned b = 0; b < body.mNumBones; ++b) {
            const aiBone& bone = *body.mBones[b];
            const Eigen::Matrix4d turn =
                world(scene->mRootNode->FindNode(bone.mName), key) * matrix(bone.mOffsetMatrix);
            for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                const aiVector3D& rest = body.mVertices[bone.mWeights[w].mVertexId];
                posed.row(bone.mWeights[w].mVertexId) +=
                    bone.mWeights[w].mWeight * (turn * Eigen::Vector4d(rest.x, rest.y, rest.z, 1)).head<3>();
            }
        }
        return posed;
    }

    Assimp::Importer importer;
    const aiScene* scene;
};

TEST_F(ExportTest, AssimpPlaysTheGltfAsTheDatasetHasIt) {
    TinyDataset().write(path("dataset.h5"));
    ExportOptions asked = options(ExportFormat::gltf, "a.glb");
    asked.rate = 2;
    EXPECT_EQ(export_dataset(asked).samples, 4);
    const Played played(path("a.glb"));
    ASSERT_TRUE(played.scene) << played.importer.GetErrorString();
    ASSERT_EQ(played.scene->mNumAnimations, 1u);
    ASSERT_EQ(played.scene->mAnimations[0]->mNumMorphMeshChannels, 1u);
    const aiMeshMorphAnim& morph = *played.scene->mAnimations[0]->mMorphMeshChannels[0];
    ASSERT_EQ(morph.mNumKeys, 5u);
    const files::DatasetReader reader(path("dataset.h5"));
    const skin::Body body = skinned_body(*reader.header().body);
    double turned = 0;
    for (unsigned key = 0; key < 5; ++key) {  // the last sample has a second key, where it ends
        const files::SampleRecord sample = reader.read(static_cast<int>(std::min(key, 3u)));
        EXPECT_NEAR(morph.mKeys[key].mTime, 500.0 * key, 1e-3);  // assimp counts milliseconds
        const aiNodeAnim& joint = *played.scene->mAnimations[0]->mChannels[0];
        EXPECT_NEAR(joint.mRotationKeys[key].mTime, 500.0 * key, 1e-3) << "body and cloth change together";
        EXPECT_LT((played.cloth(key) - sample.cloth).cwiseAbs().maxCoeff(), 1e-6);
        const Positions posed = skin::skin_positions(body, sample.pose, skin::SkinningMethod::linear);
        EXPECT_LT((played.body(key) - posed).cwiseAbs().maxCoeff(), 1e-6);
        turned = std::max(turned, (posed - body.rest_position).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(turned, 0.01) << "the poses move the body";
}

TEST_F(ExportTest, AssimpReadsTheMeshes) {
    TinyDataset().write(path("dataset.h5"));
    const files::DatasetReader reader(path("dataset.h5"));
    for (const auto& [format, extension] :
         std::map<ExportFormat, std::string>{{ExportFormat::obj, ".obj"}, {ExportFormat::ply, ".ply"}}) {
        const std::string out = extension.substr(1);
        export_dataset(options(format, out));
        const std::string name = path(out + "/cloth_000012" + extension);
        const files::MeshData cloth = files::read_mesh(name);
        EXPECT_EQ(cloth.triangle.rows(), reader.header().mesh.triangle.rows());
        const Positions expected = reader.read(2).cloth;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(cloth.position.col(axis).maxCoeff(), expected.col(axis).maxCoeff(), 1e-6);
            EXPECT_NEAR(cloth.position.col(axis).minCoeff(), expected.col(axis).minCoeff(), 1e-6);
        }
        ASSERT_EQ(cloth.texture.rows(), cloth.position.rows()) << extension;
        EXPECT_NEAR(cloth.texture.col(1).maxCoeff(), reader.header().mesh.pattern_position.col(1).maxCoeff(), 1e-6);
        EXPECT_EQ(files::read_mesh(path(out + "/body_000012" + extension)).triangle.rows(),
                  reader.header().body->triangle.rows());
    }
}

TEST_F(ExportTest, OnlyWhatIsSelectedIsWritten) {
    two_failed().write(path("dataset.h5"));
    ExportOptions asked = options(ExportFormat::obj, "accepted");
    asked.body = false;
    EXPECT_EQ(export_dataset(asked).samples, 2);
    EXPECT_THAT(names(), testing::ElementsAre("accepted", "accepted/cloth_000010.obj", "accepted/cloth_000012.obj",
                                              "dataset.h5", "dataset.timing.h5"));
    asked.out = path("all");
    asked.failed = true;
    const ExportSummary all = export_dataset(asked);
    EXPECT_EQ(all.samples, 3);
    EXPECT_EQ(all.not_finite, 1);
    asked.out = path("few");
    asked.pose = parse_pose_ranges("11,12-99");
    EXPECT_EQ(export_dataset(asked).samples, 2);
    asked.out = path("one");
    asked.at_most = 1;
    EXPECT_EQ(export_dataset(asked).samples, 1);
    EXPECT_TRUE(fs::exists(path("one/cloth_000011.obj")));
}

TEST_F(ExportTest, PosesAreNumbersAndRanges) {
    using Ranges = std::vector<std::pair<int64_t, int64_t>>;
    EXPECT_EQ(parse_pose_ranges("7"), (Ranges{{7, 7}}));
    EXPECT_EQ(parse_pose_ranges("3,10-20"), (Ranges{{3, 3}, {10, 20}}));
    for (const char* bad : {"", ",", "3,", "a", "-1", "1-", "5-3", "1 2", "99999999999999999999"})
        EXPECT_THROW(parse_pose_ranges(bad), Error) << bad;
}

TEST_F(ExportTest, WhatCannotBeWrittenIsRefusedAndLeavesNothing) {
    two_failed().write(path("dataset.h5"));
    expect_refused(options(ExportFormat::npz, "a.zip"), "does not end in .npz");
    expect_refused(options(ExportFormat::npz, "none/a.npz"), "folder does not exist");
    ExportOptions asked = options(ExportFormat::npz, "a.npz");
    asked.dataset = path("none.h5");
    expect_refused(asked, "");
    asked = options(ExportFormat::npz, "a.npz");
    asked.pose = {{500, 600}};
    expect_refused(asked, "no sample is selected");
    asked = options(ExportFormat::gltf, "a.glb");
    asked.rate = 0;
    expect_refused(asked, "rate");
    fs::create_directories(path("full"));
    std::ofstream(path("full/theirs")) << "kept";
    std::ofstream(path("file")) << "kept";
    fs::create_directories(path("folder.npz"));
    for (const ExportFormat format : {ExportFormat::obj, ExportFormat::ply, ExportFormat::pc2}) {
        expect_refused(options(format, "full"), "not empty");
        expect_refused(options(format, "file"), "in the way");
    }
    expect_refused(options(ExportFormat::npz, "folder.npz"), "a folder has this name");
    asked = options(ExportFormat::xdmf, "set.xdmf");
    fs::copy(path("dataset.h5"), path("set.body.h5"));
    asked.dataset = path("set.body.h5");
    expect_refused(asked, "would replace the data set");
}

TEST_F(ExportTest, AFullDiskLeavesNothing) {
    TinyDataset().write(path("dataset.h5"));
    const test::FileSizeLimit limit(8192);
    for (const auto& [format, out] : std::map<ExportFormat, std::string>{{ExportFormat::npz, "a.npz"},
                                                                         {ExportFormat::obj, "obj"},
                                                                         {ExportFormat::ply, "ply"},
                                                                         {ExportFormat::pc2, "pc2"},
                                                                         {ExportFormat::gltf, "a.glb"},
                                                                         {ExportFormat::xdmf, "a.xdmf"}})
        expect_refused(options(format, out), "the file would exceed the largest size");
}

TEST_F(ExportTest, TheSeriesBesideADatasetHoldsFailedSamplesToo) {
    two_failed().write(path("dataset.h5"));
    write_xdmf(path("dataset.h5"));
    std::ifstream stream(path("dataset.xdmf"));
    const std::string text((std::istreambuf_iterator<char>(stream)), {});
    for (const char* expected : {"pose_10", "pose_11", "pose_12", ">dataset.h5:/samples/cloth<",
                                 ">dataset.body.h5:/body/position<", "<Time Value=\"12\"/>"})
        EXPECT_THAT(text, HasSubstr(expected));
    EXPECT_THAT(text, testing::Not(HasSubstr("pose_13"))) << "it is not finite";
    const auto body = files::Hdf5File::open(path("dataset.body.h5"));
    EXPECT_EQ(body.shape("/body/position")[0], 3);
}

TEST_F(ExportTest, ADatasetWithoutAFiniteSampleGetsNoSeries) {
    TinyDataset tiny;
    tiny.change_sample = [](int, files::SampleRecord& sample) {
        sample.status = 1;
        sample.cloth.setConstant(std::numeric_limits<double>::quiet_NaN());
    };
    tiny.write(path("dataset.h5"));
    const auto before = names();
    write_xdmf(path("dataset.h5"));
    EXPECT_EQ(names(), before);
    ExportOptions asked = options(ExportFormat::xdmf, "a.xdmf");
    asked.failed = true;
    expect_refused(asked, "no selected sample is finite");
}

}  // namespace
}  // namespace toile::generate

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cloth/error.h"
#include "generate/validate.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::generate {
namespace {

using files::DatasetHeader;
using files::Hdf5File;
using files::SampleRecord;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class ValidateTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_validate_" + std::string(info->name()) + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "dataset.h5").string(); }

    std::vector<std::string> defects_of(const TinyDataset& dataset) const {
        dataset.write(path());
        return validate_dataset(path()).defect;
    }
    std::vector<std::string> after_header_change(std::function<void(DatasetHeader&)> change) const {
        TinyDataset dataset;
        dataset.change_header = std::move(change);
        return defects_of(dataset);
    }
    /// With sample 2 damaged before it is written, digest and all.
    std::vector<std::string> after_sample_change(const std::function<void(SampleRecord&)>& change) const {
        TinyDataset dataset;
        dataset.change_sample = [&](int slot, SampleRecord& sample) {
            if (slot == 2) change(sample);
        };
        return defects_of(dataset);
    }
    /// With the finished file edited.
    std::vector<std::string> after_file_change(const std::function<void(Hdf5File&)>& change) const {
        TinyDataset().write(path());
        Hdf5File file = Hdf5File::edit(path());
        change(file);
        file.close();
        return validate_dataset(path()).defect;
    }

    std::filesystem::path folder_;
};

TEST_F(ValidateTest, AValidFileHasNoDefects) {
    EXPECT_THAT(defects_of(TinyDataset()), IsEmpty());
    int steps = 0;
    ValidateOptions options;
    options.jobs = 2;
    options.step = [&](int done, int total) {
        EXPECT_EQ(done, ++steps);
        EXPECT_EQ(total, TinyDataset::samples);
    };
    const Validation validation = validate_dataset(path(), options);
    EXPECT_THAT(validation.defect, IsEmpty());
    EXPECT_EQ(validation.samples, TinyDataset::samples);
    EXPECT_EQ(validation.accepted, TinyDataset::samples);
    EXPECT_EQ(steps, TinyDataset::samples);
}

TEST_F(ValidateTest, AFailedSampleMayBeAnything) {
    const auto fail = [](SampleRecord& s) {
        s.status = 1;
        s.cloth(3, 1) = nan;
        s.image[7] = std::numeric_limits<float>::quiet_NaN();
        s.certificate.max_stretch = nan;
    };
    EXPECT_THAT(after_sample_change(fail), IsEmpty());
    EXPECT_EQ(validate_dataset(path()).accepted, TinyDataset::samples - 1);
}

TEST_F(ValidateTest, RefusesFilesThatAreNotOurs) {
    Hdf5File other = Hdf5File::create(path());
    other.write("/samples/id", std::vector<int64_t>{1}, {1});
    other.close();
    EXPECT_THROW(validate_dataset(path()), Error);
    std::ofstream(path()) << "not HDF5";
    EXPECT_THROW(validate_dataset(path()), Error);
    EXPECT_THROW(validate_dataset((folder_ / "none.h5").string()), Error);
}

TEST_F(ValidateTest, MissingDatasets) {
    for (const std::string name : {"/mesh/pattern_triangle", "/samples/cloth", "/samples/digest", "/samples/pose",
                                   "/samples/frame", "/image/mask", "/body/joint_bind", "/certificate/max_speed"}) {
        const auto defect = after_file_change([&](Hdf5File& file) { file.remove(name); });
        EXPECT_THAT(defect, ElementsAre(name + ": missing"));
    }
}

TEST_F(ValidateTest, WrongTypesAndShapes) {
    const auto type = after_file_change([](Hdf5File& file) {
        file.remove("/samples/status");
        file.write("/samples/status", std::vector<int32_t>(4, 0), {4});
        file.set_attribute("/samples/status", "reasons", std::vector<std::string>{"accepted"});
    });
    EXPECT_THAT(type, ElementsAre("/samples/status: holds int32, expected int8"));
    const auto count = after_file_change([](Hdf5File& file) {
        file.remove("/certificate/seconds");
        file.write("/certificate/seconds", std::vector<double>(5, 1.0), {5});
    });
    EXPECT_THAT(count, ElementsAre(AllOf(StartsWith("/certificate/seconds"), HasSubstr("4 along dimension 0"))));
    const auto rank = after_file_change([](Hdf5File& file) {
        file.remove("/samples/id");
        file.write("/samples/id", std::vector<int64_t>{10, 11, 12, 13}, {4, 1});
    });
    EXPECT_THAT(rank, testing::Contains(AllOf(StartsWith("/samples/id"), HasSubstr("expected 1 dimensions"))));
}

TEST_F(ValidateTest, AllDefectsAreReturned) {
    const auto defect = after_file_change([](Hdf5File& file) {
        file.remove("/mesh/triangle");
        file.remove("/samples/frame");
        file.remove("/image/pattern_pixel");
    });
    EXPECT_EQ(defect.size(), 3u);
}

TEST_F(ValidateTest, MissingAttributes) {
    const auto defect = after_file_change([](Hdf5File& file) {
        file.remove("/samples/split");
        file.write("/samples/split", std::vector<int8_t>{0, 0, 1, 2}, {4});
    });
    EXPECT_THAT(defect, ElementsAre(AllOf(StartsWith("/samples/split"), HasSubstr("duplicate_angle"))));
}

TEST_F(ValidateTest, MeshDefects) {
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.mesh.triangle(5, 1) = 10000; }),
                ElementsAre(AllOf(StartsWith("/mesh"), HasSubstr("triangle 5"))));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.mesh.rest_position(7, 0) = nan; }),
                ElementsAre(AllOf(StartsWith("/mesh"), HasSubstr("vertex 7"))));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.mesh.mass[4] = 0; }),
                ElementsAre(StartsWith("/mesh/mass[4]")));
}

TEST_F(ValidateTest, BodyDefects) {
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.body->weight_value[30] *= 0.5; }),
                ElementsAre(AllOf(StartsWith("/body/rest_position[15]"), HasSubstr("do not sum to one"))));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.body->weight_joint[9] = 2; }),
                ElementsAre(StartsWith("/body/weight_joint[9]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.body->joint_parent[1] = 1; }),
                ElementsAre(StartsWith("/body/joint_parent[1]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.body->joint_bind[1](0, 0) = 2; }),
                ElementsAre(StartsWith("/body/joint_bind[1]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.body->triangle(3, 2) = -1; }),
                ElementsAre(StartsWith("/body/triangle[3]")));
}

TEST_F(ValidateTest, EmbeddingAndImageDefects) {
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.embedding->triangle[2] = 1 << 20; }),
                ElementsAre(StartsWith("/embedding/triangle[2]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.embedding->barycentric(6, 0) += 0.1; }),
                ElementsAre(StartsWith("/embedding/barycentric[6]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.image->pattern_pixel(8, 1) = 48; }),
                ElementsAre(StartsWith("/image/pattern_pixel[8]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.image->pattern_pixel(8, 0) = 2; }),
                ElementsAre(StartsWith("/image/pattern_pixel[8]")));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.image->mask[5] = 7; }),
                ElementsAre(StartsWith("/image/mask[5]")));
}

TEST_F(ValidateTest, SamplesThatAreNotFinite) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.cloth(3, 1) = nan; }),
                ElementsAre("/samples/cloth[2]: vertex 3 is not finite"));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.pose(1, 0) = nan; }),
                ElementsAre("/samples/pose[2]: joint 1 is not finite"));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) {
                    for (int v = 5; v < 9; ++v) s.displacement(v, 2) = std::numeric_limits<double>::infinity();
                }),
                ElementsAre("/samples/displacement[2]: vertex 5 and 3 more is not finite"));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.image[9] = NAN; }),
                ElementsAre("/samples/image[2]: pixel 9 is not finite"));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.max_speed = nan; }),
                ElementsAre(StartsWith("/certificate/max_speed[2]")));
}

TEST_F(ValidateTest, FramesThatAreNotUnit) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.frame[4].coeffs() *= 1.001; }),
                ElementsAre("/samples/frame[2]: vertex 4 is not a unit quaternion"));
}

TEST_F(ValidateTest, TheIdentityOfDisplacement) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.cloth(3, 1) += 3e-6; }),
                ElementsAre(AllOf(StartsWith("/samples/displacement[2]: vertex 3"), HasSubstr("1e-6"))));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.cloth(3, 1) += 3e-7; }), IsEmpty());
}

TEST_F(ValidateTest, EmbeddedOffTheBody) {
    const auto shift = [](SampleRecord& s) {
        s.embedded.row(6).array() += 1e-4;
        s.cloth.row(6).array() += 1e-4;  // so that the identity holds
    };
    EXPECT_THAT(after_sample_change(shift), ElementsAre(StartsWith("/samples/embedded[2]")));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.pose(1, 2) += 0.01; }),
                testing::Contains(StartsWith("/samples/embedded[2]")));
}

TEST_F(ValidateTest, ImagesThatDoNotReadBack) {
    const auto brighten = [](SampleRecord& s) {
        for (float& value : s.image) value += 1e-4f;
    };
    EXPECT_THAT(after_sample_change(brighten), ElementsAre(StartsWith("/samples/image[2]")));
}

TEST_F(ValidateTest, CertificatesOutsideTheGate) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.residual_force = 0.01; }),
                ElementsAre(AllOf(StartsWith("/certificate/residual_force[2]"), HasSubstr("0.001"))));
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.gate["max_stretch"] = 0.1; }),
                testing::Each(StartsWith("/certificate/max_stretch[")));
}

TEST_F(ValidateTest, DetailedCertificates) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.detail->tries = 0; }),
                ElementsAre("/certificate/tries[2]: is 0"));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.detail->rung = 9; }),
                ElementsAre(StartsWith("/certificate/rung[2]: is 9")));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.detail->iterations = -1; }),
                ElementsAre(StartsWith("/certificate/iterations[2]")));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.detail->moving_share = 1.5; }),
                ElementsAre(StartsWith("/certificate/moving_share[2]")));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.self_intersections = 40; }),
                ElementsAre(StartsWith("/certificate/self_intersections[2]: says 40")));
    EXPECT_THAT(after_file_change([](Hdf5File& file) { file.remove("/certificate/rung"); }),
                ElementsAre("/certificate/rung: missing"));
    TinyDataset contracted;  // another program's data set holds the contract's seven
    contracted.change_sample = [](int, SampleRecord& s) { s.certificate.detail.reset(); };
    EXPECT_THAT(defects_of(contracted), IsEmpty());
}

TEST_F(ValidateTest, CertificatesThatTheClothDeniesWithinTheGate) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.max_stretch -= 0.01; }),
                ElementsAre(AllOf(StartsWith("/certificate/max_stretch[2]"), HasSubstr("the cloth gives"))));
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.certificate.body_penetration = 5e-4; }),
                ElementsAre(StartsWith("/certificate/body_penetration[2]")));
}

TEST_F(ValidateTest, IdsThatRepeat) {
    EXPECT_THAT(after_sample_change([](SampleRecord& s) { s.id = 10; }),
                ElementsAre("/samples/id[2]: 10 is the id of sample 0 too"));
}

TEST_F(ValidateTest, SplitsThatLeak) {
    EXPECT_THAT(after_header_change([](DatasetHeader& h) { h.duplicate_angle = 0.25; }),
                ElementsAre("/samples/split[2]: nearly the pose of sample 1, which is in another split",
                            "/samples/split[3]: nearly the pose of sample 2, which is in another split"));
}

TEST_F(ValidateTest, DigestsThatDoNotMatch) {
    const auto defect = after_file_change([](Hdf5File& file) {
        std::vector<float> cloth = file.read<float>("/samples/cloth").value;
        const files::Shape shape = file.shape("/samples/cloth");
        cloth[shape[1] * 3 + 4] += 1e-7f;
        file.remove("/samples/cloth");
        file.write("/samples/cloth", cloth, shape);
    });
    EXPECT_THAT(defect, ElementsAre(StartsWith("/samples/digest[1]")));
}

TEST_F(ValidateTest, DamagedChunksAreDefectsNotCrashes) {
    TinyDataset().write(path());
    std::string bytes;
    {
        std::ifstream stream(path(), std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(stream), {});
    }
    for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 20000 && i < bytes.size(); i += 50) bytes[i] ^= 0x40;
    std::ofstream(path(), std::ios::binary) << bytes;
    try {
        EXPECT_FALSE(validate_dataset(path()).defect.empty());
    } catch (const Error&) {  // the damage may have hit what makes it an HDF5 file
    }
}

}  // namespace
}  // namespace toile::generate

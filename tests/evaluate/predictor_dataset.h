#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include "evaluate/pose_features.h"
#include "files/dataset_file.h"
#include "pattern/embedding.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::evaluate {

/// A data set of one triangle whose displacement is linear in the rotation matrix of its second joint; the first never
/// turns. Of five samples three are in the train split, one each in the others. Ids fall from 1000.
struct PredictorDataset {
    int samples = 60;
    bool with_body = true, with_image = false;
    std::function<void(int slot, files::SampleRecord&)> change = [](int, files::SampleRecord&) {};

    /// `[9]`: a mean of 5 cm, and 2 cm for each unit of a rotation matrix' entry.
    static Positions displacement(const skin::Pose& pose) {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> uniform(-1, 1);
        const Eigen::MatrixXd field = Eigen::MatrixXd::NullaryExpr(9, 9, [&] { return 0.02 * uniform(random); });
        const Eigen::VectorXd value = field * rotation_features(pose, {1}) + Eigen::VectorXd::Constant(9, 0.05);
        return Eigen::Map<const Positions>(value.data(), 3, 3).cast<float>().cast<double>();
    }

    void write(const std::string& path) const {
        const files::DatasetHeader header = test::header_of(with_body, with_image);
        files::DatasetWriter writer(path, header, samples, 1);
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (int slot = 0; slot < samples; ++slot) {
            files::SampleRecord sample = test::sample_of(header, slot);
            sample.id = 1000 - slot;
            sample.split = std::max(0, slot % 5 - 2);
            sample.status = 0;
            if (with_body) {
                for (int k = 0; k < 3; ++k) sample.pose(1, k) = uniform(random);
                sample.pose.row(0) << 0.3, 0, 0;
                sample.displacement = displacement(sample.pose);
                sample.cloth = pattern::displaced({sample.embedded, sample.frame}, sample.displacement);
            }
            change(slot, sample);
            writer.write(slot, sample);
        }
        writer.finish();
    }
};

/// A folder of its own for each test.
class PredictorTest : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "toile_predictor_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::string path(const std::string& name) const { return (folder / name).string(); }
    std::string written(const PredictorDataset& dataset, const std::string& name = "dataset.h5") const {
        dataset.write(path(name));
        return path(name);
    }

    std::filesystem::path folder;
};

}  // namespace toile::evaluate

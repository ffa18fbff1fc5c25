#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "evaluate/case_meshes.h"
#include "evaluate/noise_floor.h"
#include "files/noise_file.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;

/// Two variants of three drapes: one shifted by `shift` [m], one scaled.
class Floor : public ::testing::Test {
  protected:
    void SetUp() override {
        path_ = (fs::temp_directory_path() / ("toile_floor_" + std::to_string(getpid()) + ".h5")).string();
    }
    void TearDown() override { fs::remove(path_); }

    files::NoiseRecord::Variant variant(int status, const Positions& cloth) const {
        files::NoiseRecord::Variant one;
        one.status = status;
        one.cloth = cloth;
        one.distance = (cloth - mesh_.rest_position).rowwise().norm();
        return one;
    }
    /// The status of the first sample's configured drape, of the others' and of the variants.
    void write(int first, int others, int variants) const {
        files::NoiseHeader header;
        header.mesh = mesh_;
        header.reasons = {"accepted", "not_at_rest"};
        header.variant = {{"half_step", "half"}, {"second_solver", "other"}};
        files::NoiseWriter writer(path_, header, 3);
        for (int k = 0; k < 3; ++k) {
            files::NoiseRecord record;
            record.id = k;
            record.status = k == 0 ? first : others;
            record.cloth = mesh_.rest_position;
            const Eigen::RowVector3d shift(0.001 * (k + 1), 0, 0);
            record.variant = {variant(variants, mesh_.rest_position.rowwise() + shift),
                              variant(variants, 1.01 * mesh_.rest_position)};
            record.spread = record.variant[0].distance.cwiseMax(record.variant[1].distance);
            record.spread_max = record.spread.maxCoeff();
            writer.write(record);
        }
        writer.finish();
    }

    ClothMesh mesh_ = grid_cloth(even_lines(4, 0.02), even_lines(3, 0.015), 0.0, 0.2);
    ClothJudge judge_{mesh_, 0.05};
    std::string path_;
};

TEST_F(Floor, IsTheLargestOfTheVariants) {
    write(0, 0, 0);
    const NoiseFloor floor = read_noise_floor(path_, judge_);
    EXPECT_EQ(floor.samples, 6);
    EXPECT_NEAR(at(floor.value, Quantity::sqrt_mse), std::sqrt((1.0 + 4 + 9) / 3), 1e-6) << "of the shifted drapes";
    EXPECT_NEAR(at(floor.value, Quantity::max_dist), 2.0, 1e-6);
    EXPECT_NEAR(at(floor.value, Quantity::largest_stretch), 0.01, 1e-6) << "of the scaled ones";
    EXPECT_GT(at(floor.value, Quantity::stretching_energy_error), 0.0);
    EXPECT_TRUE(std::isnan(at(floor.value, Quantity::penetration))) << "the file has no body";
}

TEST_F(Floor, CountsDrapesWithinTheGateAlone) {
    write(1, 0, 0);
    EXPECT_EQ(read_noise_floor(path_, judge_).samples, 4);
    EXPECT_NEAR(at(read_noise_floor(path_, judge_).value, Quantity::max_dist), 2.5, 1e-6);
    write(1, 1, 0);
    EXPECT_THROW(read_noise_floor(path_, judge_), Error);
    write(0, 0, 1);
    EXPECT_THROW(read_noise_floor(path_, judge_), Error);
}

TEST_F(Floor, IsOfThisMesh) {
    write(0, 0, 0);
    const ClothMesh other = grid_cloth(even_lines(5, 0.02), even_lines(3, 0.015), 0.0, 0.2);
    EXPECT_THROW(read_noise_floor(path_, ClothJudge(other, 0.05)), Error);
}

}  // namespace
}  // namespace toile::evaluate

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/mu_picture.h"
#include "files/hdf5_file.h"
#include "files/mesh_group.h"
#include "tests/prior/quasistatic_cases.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A sheet whose pattern is itself, and a second panel of the same shape on the same place: a front and a back that
/// share no vertex.
ClothMesh two_panels() {
    const ClothMesh one = prior::test::sheet(9, 7, 0.05, 0.0);
    ClothMesh mesh;
    const int n = one.vertex_count();
    mesh.rest_position.resize(2 * n, 3);
    mesh.rest_position << one.rest_position, one.rest_position.rowwise() + Eigen::RowVector3d(0, 0, 0.2);
    mesh.triangle.resize(2 * one.triangle_count(), 3);
    mesh.triangle << one.triangle, one.triangle.array() + n;
    mesh.pattern_position = mesh.rest_position.leftCols(2);
    mesh.pattern_triangle = mesh.triangle;
    return mesh;
}

/// Red, green, blue.
std::array<int, 3> pixel(const files::Picture& picture, double x, double y) {
    const size_t at =
        3 * (static_cast<size_t>(y * picture.height) * picture.width + static_cast<size_t>(x * picture.width));
    return {picture.value[at], picture.value[at + 1], picture.value[at + 2]};
}
bool yellow(const std::array<int, 3>& c) {
    return c[0] > 180 && c[1] > 150 && c[2] < 80;
}
bool purple(const std::array<int, 3>& c) {
    return c[0] < 110 && c[1] < 30 && c[2] > 50;
}

TEST(MuPicture, IsYellowWhereMuIsHighAndPurpleWhereItIsLow) {
    const ClothMesh mesh = two_panels();
    Eigen::VectorXd mu(mesh.vertex_count());
    mu << Eigen::VectorXd::Constant(mesh.vertex_count() / 2, 0.01),
        Eigen::VectorXd::Constant(mesh.vertex_count() / 2, 10);
    const files::Picture picture = mu_picture(mesh, mu);
    ASSERT_EQ(picture.channels, 3);
    ASSERT_EQ(picture.value.size(), 3u * static_cast<size_t>(picture.width) * picture.height);
    int yellows = 0, purples = 0, white = 0;
    for (size_t i = 0; i < picture.value.size(); i += 3) {
        const std::array<int, 3> c{picture.value[i], picture.value[i + 1], picture.value[i + 2]};
        yellows += yellow(c);
        purples += purple(c);
        white += c[0] == 255 && c[1] == 255 && c[2] == 255;
    }
    const int all = picture.width * picture.height;
    EXPECT_NEAR(static_cast<double>(yellows) / purples, 1.0, 0.1) << "the panels do not cover each other";
    EXPECT_GT(yellows, all / 10);
    EXPECT_GT(white, all / 20) << "the ground";
    EXPECT_TRUE(purple(pixel(picture, 0.2, 0.2))) << "the first panel comes first";
}

TEST(MuPicture, DrawsClothWithoutPatternAsWorn) {
    ClothMesh mesh = two_panels();
    mesh.pattern_position.resize(0, 2);
    mesh.pattern_triangle.resize(0, 3);
    Eigen::VectorXd mu(mesh.vertex_count());
    mu << Eigen::VectorXd::Constant(mesh.vertex_count() / 2, 0.01),
        Eigen::VectorXd::Constant(mesh.vertex_count() / 2, 10);
    const files::Picture picture = mu_picture(mesh, mu);
    EXPECT_TRUE(yellow(pixel(picture, 0.2, 0.2))) << "from the front, the sheet nearer to the viewer";
    EXPECT_GT(picture.height, 100);
}

TEST(MuPicture, CopesWithOneNumber) {
    const ClothMesh mesh = prior::test::sheet(4, 4);
    EXPECT_NO_THROW(mu_picture(mesh, Eigen::VectorXd::Constant(16, 0.1)));
}

TEST(MuPicture, BecomesABlockWithAnAltText) {
    const ClothMesh mesh = prior::test::sheet(4, 4);
    Eigen::VectorXd mu(16);
    for (int i = 0; i < 16; ++i) mu[i] = 0.1 * (i + 1);
    const ReportPicture block = mu_block(mesh, mu, "mu-picture");
    EXPECT_EQ(block.id, "mu-picture");
    EXPECT_THAT(block.src, StartsWith("data:image/png;base64,iVBOR"));
    EXPECT_THAT(block.alt, HasSubstr("from 0.1 (purple) to 1.6 (yellow), median 0.8"));
    EXPECT_NO_THROW(as_json(ReportSection{"accuracy", "Accuracy", {}, {block}}));
}

TEST(MuPicture, IsMadeOfWhatWasLearned) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("toile_mu_" + std::to_string(getpid()) + ".h5")).string();
    const ClothMesh mesh = prior::test::sheet(4, 4);
    const auto write = [&](int values) {
        files::Hdf5File file = files::Hdf5File::create(path);
        files::write_mesh_group(file, mesh, 0);
        if (values > 0) file.write("/mu/vertex", std::vector<double>(static_cast<size_t>(values), 0.2), {values});
        file.close();
    };
    write(16);
    const std::optional<ReportPicture> block = learned_mu_block(path);
    ASSERT_TRUE(block);
    EXPECT_THAT(block->alt, HasSubstr("median 0.2"));
    write(0);
    EXPECT_FALSE(learned_mu_block(path)) << "only a global mu was learned";
    write(15);
    EXPECT_THROW(learned_mu_block(path), Error);
    std::filesystem::remove(path);
    EXPECT_THROW(learned_mu_block(path), Error);
}

TEST(MuPicture, RefusesWhatDoesNotFit) {
    const ClothMesh mesh = prior::test::sheet(4, 4);
    EXPECT_THROW(mu_picture(mesh, Eigen::VectorXd::Constant(15, 0.1)), Error);
    EXPECT_THROW(mu_picture(mesh, Eigen::VectorXd::Zero(16)), Error);
    EXPECT_THROW(mu_picture(mesh, Eigen::VectorXd::Constant(16, std::nan(""))), Error);
}

}  // namespace
}  // namespace toile::evaluate

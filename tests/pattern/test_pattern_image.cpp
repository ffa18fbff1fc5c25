#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "cloth/error.h"
#include "pattern/garment_file.h"
#include "pattern/pattern_image.h"
#include "pattern/rasterizer.h"
#include "tests/pattern/two_panels.h"

namespace toile::pattern {
namespace {

ImageOptions options_of(int size, ImageLayout layout) {
    ImageOptions options;
    options.size = size;
    options.layout = layout;
    return options;
}

ResamplingError error_of(const PatternImage& image, const Positions& displacement) {
    ResamplingError error;
    error.add(displacement, image.read(image.image(displacement)));
    return error;
}

/// The contract's words in code of their own: bilinear at `pattern_pixel`, averaged over a vertex' pattern positions.
Positions read_by_contract(const ClothMesh& mesh, const PatternLayout& layout, const std::vector<float>& image) {
    std::vector<std::set<int>> position(static_cast<size_t>(mesh.vertex_count()));
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int k = 0; k < 3; ++k) position[mesh.triangle(f, k)].insert(mesh.pattern_triangle(f, k));
    Positions value = Positions::Zero(mesh.vertex_count(), 3);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        for (const int p : position[v]) {
            const double column = layout.pattern_pixel(p, 1), row = layout.pattern_pixel(p, 2);
            for (int c = 0; c < 3; ++c) {
                const size_t channel = 3 * static_cast<size_t>(layout.pattern_pixel(p, 0)) + c;
                double sum = 0;
                for (int j = static_cast<int>(row); j <= static_cast<int>(row) + 1; ++j)
                    for (int i = static_cast<int>(column); i <= static_cast<int>(column) + 1; ++i)
                        sum += (1 - std::abs(column - i)) * (1 - std::abs(row - j)) *
                               image[(channel * layout.size + j) * layout.size + i];
                value(v, c) += sum / static_cast<double>(position[v].size());
            }
        }
    }
    return value;
}

class PatternImageTest : public testing::TestWithParam<ImageLayout> {
  protected:
    TwoPanels cloth = two_panels(10);
    PatternImage image_of(int size) const {
        return PatternImage(cloth.mesh, cloth.triangle_panel, options_of(size, GetParam()));
    }
};
INSTANTIATE_TEST_SUITE_P(Layouts, PatternImageTest, testing::Values(ImageLayout::layers, ImageLayout::atlas));

TEST_P(PatternImageTest, ConstantIsExactAtEveryCoveredPixel) {
    const PatternImage pattern_image = image_of(48);
    Positions constant(cloth.mesh.vertex_count(), 3);
    constant.rowwise() = Eigen::RowVector3d(0.01, -0.02, 0.03);
    const std::vector<float> image = pattern_image.image(constant);
    const size_t area = 48 * 48;
    int covered = 0;
    for (size_t i = 0; i < pattern_image.mask().size(); ++i) {
        if (!pattern_image.mask()[i]) continue;
        ++covered;
        const size_t layer = i / area;
        EXPECT_NEAR(image[(3 * layer) * area + i % area], 0.01, 1e-8);
        EXPECT_NEAR(image[(3 * layer + 2) * area + i % area], 0.03, 1e-8);
    }
    EXPECT_GT(covered, 200);
    EXPECT_LT(error_of(pattern_image, constant).largest, 1e-8);
}

TEST_P(PatternImageTest, LinearFieldsAreExactUpToTheEdge) {
    // Linear in each panel and the same along the seam, so that seam vertices read the same from both sides.
    Positions linear(cloth.mesh.vertex_count(), 3);
    for (int v = 0; v < cloth.mesh.vertex_count(); ++v) {
        const double x = cloth.mesh.rest_position(v, 0) - 0.2, y = cloth.mesh.rest_position(v, 1);
        linear.row(v) << 0.1 * x, 0.05 * y, x < 0 ? 0.2 * x : -0.3 * x;
    }
    EXPECT_LT(error_of(image_of(64), linear).largest, 2e-9);
}

TEST_P(PatternImageTest, ReadsAsTheContractSays) {
    const PatternImage pattern_image = image_of(40);
    const std::vector<float> image = pattern_image.image(fold_probe(cloth.mesh.rest_position));
    const Positions by_contract = read_by_contract(cloth.mesh, pattern_image.layout(), image);
    EXPECT_LT((by_contract - pattern_image.read(image)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(PatternImageTest, PanelsDoNotBleed) {
    // +1 on one panel, -1 on the other, the seam between them on the side of the first.
    Positions opposite(cloth.mesh.vertex_count(), 3);
    for (int v = 0; v < cloth.mesh.vertex_count(); ++v)
        opposite.row(v).setConstant(cloth.mesh.rest_position(v, 0) < 0.2 + 1e-9 ? 0.01 : -0.01);
    const PatternImage pattern_image = image_of(64);
    const std::vector<float> image = pattern_image.image(opposite);
    const PatternLayout& layout = pattern_image.layout();
    // No pixel that the first panel's reading can touch holds anything but its own value.
    const Eigen::Index first_panel = layout.pattern_pixel.rows() / 2;
    for (Eigen::Index p = 0; p < first_panel; ++p) {
        for (int corner = 0; corner < 4; ++corner) {
            const int column = static_cast<int>(layout.pattern_pixel(p, 1)) + corner % 2;
            const int row = static_cast<int>(layout.pattern_pixel(p, 2)) + corner / 2;
            const auto layer = static_cast<size_t>(layout.pattern_pixel(p, 0));
            EXPECT_NEAR(image[(3 * layer * 64 + row) * 64 + column], 0.01, 1e-4);
        }
    }
    EXPECT_LT(error_of(pattern_image, opposite).largest, 5e-4);
}

TEST_P(PatternImageTest, MaskCoversTheAreaOfThePattern) {
    const PatternImage pattern_image = image_of(96);
    double covered = 0;
    for (const uint8_t m : pattern_image.mask()) covered += m;
    const double pixel = pattern_image.layout().pixel;
    EXPECT_NEAR(covered * pixel * pixel, 2 * 0.2 * 0.2, 0.04 * 0.08);
}

TEST_P(PatternImageTest, ErrorFallsWithTheSize) {
    const Positions folds = fold_probe(cloth.mesh.rest_position);
    double previous = 1.0;
    for (const int size : {24, 48, 96}) {
        const double error = error_of(image_of(size), folds).root_mean_square();
        EXPECT_LT(error, 0.7 * previous) << size;
        previous = error;
    }
    EXPECT_LT(previous, 5e-5);
}

TEST_P(PatternImageTest, ImagesStayCloseToTheRasterisedField) {
    const PatternImage pattern_image = image_of(96);
    const Positions folds = fold_probe(cloth.mesh.rest_position);
    const std::vector<float> image = pattern_image.image(folds);
    const Positions plain = rasterize(cloth.mesh, pattern_image.layout()).vertex_to_pixel * folds;
    const size_t area = 96 * 96;
    double squared = 0, count = 0, mean_square = 0;
    for (size_t i = 0; i < pattern_image.mask().size(); ++i) {
        if (!pattern_image.mask()[i]) continue;
        const double normal = plain(static_cast<Eigen::Index>(i), 2);
        squared += std::pow(image[(3 * (i / area) + 2) * area + i % area] - normal, 2);
        mean_square += normal * normal;
        ++count;
    }
    EXPECT_GT(mean_square / count, 1e-6);
    EXPECT_LT(squared, 0.05 * mean_square);
}

TEST_P(PatternImageTest, DegeneratePatternTrianglesAreSurvived) {
    const int p = cloth.mesh.pattern_triangle(30, 0);
    const int q = cloth.mesh.pattern_triangle(30, 1);
    cloth.mesh.pattern_position.row(p) = cloth.mesh.pattern_position.row(q);
    const PatternImage pattern_image = image_of(64);
    Positions constant = Positions::Constant(cloth.mesh.vertex_count(), 3, 0.01);
    const ResamplingError error = error_of(pattern_image, constant);
    EXPECT_TRUE(std::isfinite(error.largest));
    EXPECT_LT(error.largest, 1e-6);
}

TEST_P(PatternImageTest, AutoTakesTheSmallestSizeUnderTheBound) {
    cloth = two_panels(40);  // finer than 32 pixels
    const std::vector<Positions> probe{fold_probe(cloth.mesh.rest_position)};
    ImageOptions options = options_of(0, GetParam());
    options.max_error = 0.0001;
    const AutoImageSize chosen = auto_image_size(cloth.mesh, cloth.triangle_panel, options, probe);
    ASSERT_TRUE(chosen.reached);
    EXPECT_LE(error_of(image_of(chosen.size), probe[0]).largest, options.max_error);
    EXPECT_EQ(error_of(image_of(chosen.size), probe[0]).largest, chosen.error.largest);
    ASSERT_GT(chosen.size, 32);
    for (const int smaller : {32, 48, 64, 96, 128}) {
        if (smaller >= chosen.size) break;
        EXPECT_GT(error_of(image_of(smaller), probe[0]).largest, options.max_error);
    }
}

TEST(PatternImage, AutoSaysWhenNoSizeIsEnough) {
    const TwoPanels cloth = two_panels(10);
    ImageOptions options = options_of(0, ImageLayout::atlas);
    options.max_error = 1e-12;
    const AutoImageSize chosen =
        auto_image_size(cloth.mesh, cloth.triangle_panel, options, {fold_probe(cloth.mesh.rest_position)});
    EXPECT_FALSE(chosen.reached);
    EXPECT_EQ(chosen.size, 1024);
}

TEST_P(PatternImageTest, WhatIsNotFiniteGivesNaN) {
    Positions bad = Positions::Zero(cloth.mesh.vertex_count(), 3);
    bad(3, 1) = std::numeric_limits<double>::infinity();
    for (const float value : image_of(32).image(bad)) ASSERT_TRUE(std::isnan(value));
}

double pattern_area(const ClothMesh& mesh) {
    double area = 0;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const Eigen::RowVector2d a = mesh.pattern_position.row(mesh.pattern_triangle(f, 0));
        const Eigen::RowVector2d b = mesh.pattern_position.row(mesh.pattern_triangle(f, 1)) - a;
        const Eigen::RowVector2d c = mesh.pattern_position.row(mesh.pattern_triangle(f, 2)) - a;
        area += 0.5 * std::abs(b.x() * c.y() - b.y() * c.x());
    }
    return area;
}

TEST(PatternImage, RealGarmentsReadBack) {
    const std::string folder = TOILE_SHARED_DATA "/garments/";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
    for (const char* name : {"tshirt_female.obj", "tshirt_male.obj", "skirt_female.obj"}) {
        const Garment garment = read_garment(folder + name, {}, nullptr);
        for (const ImageLayout layout : {ImageLayout::layers, ImageLayout::atlas}) {
            const PatternImage image(garment.mesh, garment.triangle_panel, options_of(192, layout));
            const ResamplingError error = error_of(image, fold_probe(garment.mesh.rest_position));
            EXPECT_LT(error.largest, 2e-4) << name;
            EXPECT_LT(error.root_mean_square(), 3e-5) << name;
            double covered = 0;
            for (const uint8_t m : image.mask()) covered += m;
            covered *= image.layout().pixel * image.layout().pixel;
            EXPECT_NEAR(covered, pattern_area(garment.mesh), 0.01 * covered) << name;
        }
    }
}

TEST(PatternImage, RefusesSizesOutOfRange) {
    const TwoPanels cloth = two_panels(2);
    for (const int size : {-1, 0, 15, 4097})
        EXPECT_THROW(PatternImage(cloth.mesh, cloth.triangle_panel, options_of(size, ImageLayout::layers)), Error);
}

}  // namespace
}  // namespace toile::pattern

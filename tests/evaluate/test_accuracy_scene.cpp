#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "evaluate/accuracy_scene.h"
#include "files/hdf5_file.h"
#include "tests/evaluate/evaluated_folder.h"
#include "tests/evaluate/page_blob.h"

namespace toile::evaluate {
namespace {

class AccuracyScene : public testing::Test {
  protected:
    void SetUp() override { folder_.write_arrays(); }

    /// Puts another dataset in the place of one; what is wrong with that: "dataset: what".
    template <typename T>
    std::string complaint(const std::string& dataset, const std::vector<T>& value, const files::Shape& shape) {
        std::filesystem::remove(folder_.file("accuracy.h5"));
        folder_.write_arrays();
        {
            files::Hdf5File file = files::Hdf5File::edit(folder_.file("accuracy.h5"));
            file.remove(dataset);
            if (!value.empty()) file.write(dataset, value, shape);
            file.close();
        }
        try {
            accuracy_scene(folder_.path());
        } catch (const Error& error) {
            EXPECT_THAT(error.where(), testing::StartsWith(folder_.file("accuracy.h5")));
            return error.where().substr(folder_.file("accuracy.h5").size()) + ": " + error.what();
        }
        return "none";
    }

    EvaluatedFolder folder_;
};

TEST_F(AccuracyScene, shows_what_the_file_holds) {
    const std::optional<SceneData> data = accuracy_scene(folder_.path());
    ASSERT_TRUE(data);
    const ReportScene& scene = data->scene;
    ASSERT_EQ(scene.views.size(), 3u);
    EXPECT_EQ(scene.views[0].key, "target");
    EXPECT_EQ(scene.views[2].name, "the quasistatic");
    ASSERT_EQ(scene.samples.size(), 2u);
    const SceneSample& first = scene.samples[0];
    EXPECT_EQ(first.id, 17);
    EXPECT_EQ(first.split, "test");
    EXPECT_EQ(scene.samples[1].split, "train");
    ASSERT_EQ(first.error_mm.size(), 2u) << "not of the target";
    EXPECT_EQ(first.error_mm[0].first, "predicted");
    EXPECT_NEAR(first.error_mm[0].second, 10.0, 1e-4) << "root mean square of 0, 0, 0, 20 mm";
    ASSERT_TRUE(first.body);
    EXPECT_EQ(first.body->count, 3);
    ASSERT_EQ(first.cloth.size(), 3u);
    EXPECT_EQ(first.cloth[0].position.count, 4);
    EXPECT_EQ(first.cloth[0].fields.size(), 3u);
    ASSERT_EQ(first.image.size(), 3u);
    EXPECT_THAT(first.image[0].name, testing::HasSubstr("-12 to 12 mm"));
    EXPECT_GT(data->bytes(), data->store.bytes());
}

TEST_F(AccuracyScene, positions_are_those_of_the_file) {
    const std::optional<SceneData> data = accuracy_scene(folder_.path());
    const PackedNumbers& place = data->scene.samples[1].cloth[0].position;
    const size_t index = std::stoul(place.blob.substr(5));
    const std::vector<std::uint16_t> step = blob_values<std::uint16_t>(data->store.blobs().at(index));
    ASSERT_EQ(step.size(), 12u);
    for (size_t k = 0; k < 12; ++k)
        EXPECT_NEAR(place.low[k % 3] + step[k] * (place.high[k % 3] - place.low[k % 3]) / 65535,
                    0.01 * static_cast<double>(12 + k), 1e-6);
    const size_t triangle = std::stoul(data->scene.triangle.substr(5));
    EXPECT_EQ(blob_values<std::int32_t>(data->store.blobs().at(triangle)),
              (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3}));
}

TEST_F(AccuracyScene, a_cloth_that_is_not_finite_is_left_out) {
    const std::optional<SceneData> data = accuracy_scene(folder_.path());
    ASSERT_EQ(data->scene.samples[1].cloth.size(), 2u);
    EXPECT_EQ(data->scene.samples[1].cloth[1].view, "predicted");
}

TEST_F(AccuracyScene, fields_have_the_ranges_that_their_colours_need) {
    const std::vector<SceneField> fields = accuracy_scene(folder_.path())->scene.fields;
    ASSERT_EQ(fields.size(), 4u);
    EXPECT_EQ(fields[0].map, "stretch");
    EXPECT_EQ(fields[0].low, 0.75);
    EXPECT_EQ(fields[0].high, 1.25);
    EXPECT_EQ(fields[1].unit, "mm");
    EXPECT_EQ(fields[1].low, 0.0);
    EXPECT_NEAR(fields[1].high, 10.0, 1e-4) << "what 99 of 100 vertices of the worst cloth stay below";
    EXPECT_EQ(fields[2].low, -fields[2].high);
    EXPECT_EQ(fields[3].key, "mu");
    EXPECT_NEAR(fields[3].low, -2.0, 1e-6);
    EXPECT_NEAR(fields[3].high, 1.0, 1e-6);
}

TEST_F(AccuracyScene, nothing_is_shown_where_nothing_is_there) {
    std::filesystem::remove(folder_.file("accuracy.h5"));
    EXPECT_FALSE(accuracy_scene(folder_.path()));
    {
        files::Hdf5File file = files::Hdf5File::create(folder_.file("accuracy.h5"));
        file.set_attribute("/", "format", "toile accuracy");
        file.set_attribute("/", "version", 1);
        file.close();
    }
    EXPECT_FALSE(accuracy_scene(folder_.path()));
}

TEST_F(AccuracyScene, bodies_and_images_may_be_absent) {
    EXPECT_EQ(complaint("/shown/body", std::vector<float>{}, {}), "none");
    EXPECT_FALSE(accuracy_scene(folder_.path())->scene.samples[0].body);
    EXPECT_EQ(complaint("/shown/image", std::vector<float>{}, {}), "none");
    EXPECT_TRUE(accuracy_scene(folder_.path())->scene.samples[0].image.empty());
}

TEST_F(AccuracyScene, one_defect_at_a_time) {
    using testing::HasSubstr;
    using testing::StartsWith;
    const auto integers = [](int count) { return std::vector<std::int32_t>(count, 0); };
    const auto numbers = [](int count) { return std::vector<float>(count, 1.0f); };
    EXPECT_THAT(complaint("/mesh/triangle", std::vector<std::int32_t>{0, 1, 4}, {1, 3}), HasSubstr("vertex 4"));
    EXPECT_THAT(complaint("/mesh/triangle", std::vector<std::int32_t>{0, -1, 3}, {1, 3}), HasSubstr("vertex -1"));
    EXPECT_THAT(complaint("/body/triangle", std::vector<std::int32_t>{0, 1, 3}, {1, 3}), HasSubstr("vertex 3"));
    EXPECT_NE(complaint("/mesh/triangle", integers(0), {}), "none");
    EXPECT_NE(complaint("/mesh/triangle", integers(8), {2, 4}), "none");
    EXPECT_THAT(complaint("/shown/split", std::vector<std::int8_t>{0, 3}, {2}), StartsWith(":/shown/split: "));
    EXPECT_NE(complaint("/shown/split", std::vector<std::int8_t>{0}, {1}), "none");
    EXPECT_THAT(complaint("/shown/predicted/position", numbers(30), {2, 5, 3}), HasSubstr("(2, 4, 3)"));
    EXPECT_THAT(complaint("/shown/predicted/stretch", numbers(10), {2, 5}), StartsWith(":/shown/predicted/stretch"));
    EXPECT_NE(complaint("/shown/body", numbers(9), {1, 3, 3}), "none");
    EXPECT_THAT(complaint("/shown/image", numbers(2 * 4), {2, 4, 1, 1}), HasSubstr("multiple of three"));
    EXPECT_NE(complaint("/mu/vertex", numbers(5), {5}), "none");
}

TEST_F(AccuracyScene, a_file_of_another_version_or_of_others_is_refused) {
    {
        files::Hdf5File file = files::Hdf5File::edit(folder_.file("accuracy.h5"));
        file.set_attribute("/", "version", 2);
        file.close();
    }
    EXPECT_THROW(accuracy_scene(folder_.path()), Error);
    std::ofstream(folder_.file("accuracy.h5")) << "no HDF5";
    EXPECT_THROW(accuracy_scene(folder_.path()), Error);
}

}  // namespace
}  // namespace toile::evaluate

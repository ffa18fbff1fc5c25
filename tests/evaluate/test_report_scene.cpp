#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluate/report_scene.h"
#include "tests/evaluate/page_blob.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

TEST(ReportScene, positions_come_back_within_half_a_step) {
    std::vector<float> value;
    for (int k = 0; k < 300; ++k) value.push_back(static_cast<float>(std::sin(k) * (k % 3 + 1)));
    BlobStore store;
    const PackedNumbers packed = store.pack(value, 3);
    EXPECT_EQ(packed.count, 100);
    ASSERT_EQ(packed.low.size(), 3u);
    const std::vector<std::uint16_t> step = blob_values<std::uint16_t>(store.blobs().at(0));
    ASSERT_EQ(step.size(), value.size());
    for (size_t k = 0; k < value.size(); ++k) {
        const double width = packed.high[k % 3] - packed.low[k % 3];
        EXPECT_NEAR(packed.low[k % 3] + step[k] * width / 65535, value[k], 0.51 * width / 65535);
    }
}

TEST(ReportScene, ends_are_exact_and_what_is_no_number_is_the_lowest) {
    BlobStore store;
    const PackedNumbers packed = store.pack({1.0f, NAN, 3.0f, INFINITY, 2.0f}, 1);
    EXPECT_EQ(packed.low, std::vector<double>{1.0});
    EXPECT_EQ(packed.high, std::vector<double>{3.0});
    EXPECT_EQ(blob_values<std::uint16_t>(store.blobs()[0]), (std::vector<std::uint16_t>{0, 0, 65535, 0, 32768}));
}

TEST(ReportScene, equal_numbers_and_none_at_all_are_stored) {
    BlobStore store;
    const PackedNumbers equal = store.pack({2.0f, 2.0f}, 1), none = store.pack({NAN}, 1);
    EXPECT_EQ(equal.low, equal.high);
    EXPECT_EQ(blob_values<std::uint16_t>(store.blobs()[0]), (std::vector<std::uint16_t>{0, 0}));
    EXPECT_EQ(none.low, std::vector<double>{0.0});
}

TEST(ReportScene, triangles_come_back_and_blobs_are_numbered) {
    BlobStore store;
    EXPECT_EQ(store.pack(std::vector<std::int32_t>{0, 70'000, 2}), "blob-0");
    EXPECT_EQ(store.pack({1.0f}, 1).blob, "blob-1");
    EXPECT_EQ(blob_values<std::int32_t>(store.blobs()[0]), (std::vector<std::int32_t>{0, 70'000, 2}));
    EXPECT_EQ(store.bytes(), store.blobs()[0].text.size() + store.blobs()[1].text.size());
}

TEST(ReportScene, the_json_is_what_the_page_takes) {
    ReportScene scene;
    scene.triangle = "blob-0";
    scene.views = {{"target", "the truth"}};
    scene.fields = {{"stretch", "stretch", "", 0.75, 1.25, "stretch"}};
    const PackedNumbers place{"blob-1", {0, 0, 0}, {1, 2, 3}, 5}, stretch{"blob-2", {0.9}, {1.1}, 5};
    scene.samples = {
        {17, "test", {{"predicted", NAN}}, {}, {{"target", place, {{"stretch", stretch}}}}, {{"Δu", "data:,"}}}};
    EXPECT_EQ(as_json(scene), Json::parse(R"({
        "triangle": "blob-0", "body_triangle": null, "views": [{"key": "target", "name": "the truth"}],
        "fields": [{"key": "stretch", "name": "stretch", "unit": "", "low": 0.75, "high": 1.25, "map": "stretch"}],
        "samples": [{"id": 17, "split": "test", "error_mm": {"predicted": null}, "body": null,
            "cloth": {"target": {
                "position": {"blob": "blob-1", "low": [0.0, 0.0, 0.0], "high": [1.0, 2.0, 3.0], "count": 5},
                "fields": {"stretch": {"blob": "blob-2", "low": 0.9, "high": 1.1, "count": 5}}}},
            "image": [{"name": "Δu", "src": "data:,"}]}]})"));
    scene.body_triangle = "blob-3";
    scene.samples[0].body = place;
    scene.mu = stretch;
    EXPECT_EQ(as_json(scene).at("body_triangle"), "blob-3");
    EXPECT_EQ(as_json(scene).at("samples").at(0).at("body").at("count"), 5);
    EXPECT_EQ(as_json(scene).at("vertex_fields").at("mu").at("blob"), "blob-2");
}

}  // namespace
}  // namespace toile::evaluate

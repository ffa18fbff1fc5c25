#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

void bind_dataset(ConfigTable& root, SceneConfig& config) {
    if (auto table = root.table("image", "the displacement rasterised over the pattern")) {
        config.image.emplace();
        pattern::ImageOptions& image = *config.image;
        std::optional<int> size;
        if (image.size > 0) size = image.size;
        table->integer_or(
            "size", size, "auto",
            {.lower = 16, .upper = 4096, .unit = "pixels", .doc = "height and width; auto: the smallest"});
        image.size = size.value_or(0);
        table->real("max_error", image.max_error,
                    {.lower = 0, .upper = 1, .above = true, .unit = "m", .doc = "that auto stays under, on its probe"});
        table->integer("probe", image.probe,
                       {.lower = 1, .upper = 1024, .doc = "poses, spread over all, that auto is chosen on"});
        table->choice<pattern::ImageLayout>(
            "layout", image.layout, {{"layers", pattern::ImageLayout::layers}, {"atlas", pattern::ImageLayout::atlas}},
            "each panel a layer of its own, or all side by side");
    }
    if (config.body || root.has("split")) {
        ConfigTable table = root.section("split", "how samples are divided; near-duplicates stay together");
        table.real("validation", config.split.validation_share, {.lower = 0, .upper = 1, .doc = "share"});
        table.real("test", config.split.test_share, {.lower = 0, .upper = 1, .doc = "share"});
        table.real("duplicate_angle", config.split.duplicate_angle,
                   {.lower = 0, .upper = 3.1415, .unit = "rad", .doc = "poses closer than this are near-duplicates"});
        config.split.seed = config.seed;
        if (config.split.validation_share + config.split.test_share > 1)
            table.fail("validation", "and split.test come to more than 1");
    }
    if (config.body || root.has("output")) {
        ConfigTable table = root.section("output", "the files that are written");
        table.integer("compression", config.output.compression, {.lower = 0, .upper = 9, .doc = "gzip level"});
        table.integer("part", config.output.part,
                      {.lower = 1, .upper = 65536, .doc = "samples that a shard seals together"});
        table.integers("look", config.output.look, {.lower = 0, .doc = "pose numbers to write pictures of"});
    }
}

}  // namespace toile::generate

#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

namespace {

void bind_tshirt(ConfigTable& table, pattern::TshirtOptions& t) {
    table.real("edge_length", t.edge_length, {.lower = 0.006, .upper = 0.05, .unit = "m", .doc = "of the triangles"});
    table.real("ease", t.ease,
               {.lower = 0.02, .upper = 0.6, .doc = "share by which the chest is wider than the body's"});
    table.real("body_length", t.body_length,
               {.lower = 0, .upper = 1.5, .unit = "m", .doc = "neck to hem; 0: a little past the hip joints"});
    table.real("sleeve_length", t.sleeve_length,
               {.lower = 0, .upper = 1, .unit = "m", .doc = "shoulder to cuff; 0: three quarters of the upper arm"});
}

}  // namespace

void bind_garment(ConfigTable& root, SceneConfig& config) {
    auto table = root.table("garment", "the cloth");
    if (!table) root.fail("garment", "is missing: a scene needs a table [garment]");
    GarmentConfig& garment = config.garment;
    table->choice<GarmentSource>(
        "source", garment.source,
        {{"tshirt", GarmentSource::tshirt}, {"patch", GarmentSource::patch}, {"file", GarmentSource::file}},
        "cut to the body, a rectangle, or a mesh with texture coordinates");
    if (garment.source == GarmentSource::tshirt) bind_tshirt(*table, garment.tshirt);
}

}  // namespace toile::generate

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

void bind_patch(ConfigTable& table, pattern::PatchOptions& p) {
    table.real("width", p.width, {.lower = 0.02, .upper = 10, .unit = "m", .doc = "along x"});
    table.real("height", p.height, {.lower = 0.02, .upper = 10, .unit = "m"});
    table.real("edge_length", p.edge_length,
               {.lower = 0.002, .upper = 1, .unit = "m", .doc = "of the triangles, at most half of width and height"});
    table.choice<pattern::PatchOrientation>(
        "orientation", p.orientation,
        {{"vertical", pattern::PatchOrientation::vertical}, {"horizontal", pattern::PatchOrientation::horizontal}},
        "hangs from y = 0 facing +z, or lies on y = 0 facing +y");
}

void bind_file(ConfigTable& table, GarmentConfig& garment) {
    pattern::GarmentFileOptions& f = garment.file_options;
    table.path("file", garment.file, "OBJ or glTF with texture coordinates");
    if (garment.file.written.empty()) table.fail("file", "is missing: garment.source is \"file\"");
    table.real("unit_scale", f.unit_scale,
               {.lower = 1e-6, .upper = 1000, .unit = "m", .doc = "length of the file's unit"});
    table.choice<pattern::UpAxis>("up", f.up,
                                  {{"x", pattern::UpAxis::x}, {"y", pattern::UpAxis::y}, {"z", pattern::UpAxis::z}},
                                  "axis of the file that points up");
    table.real(
        "pattern_scale", f.pattern_scale,
        {.lower = 0, .upper = 1000, .unit = "m", .doc = "length of a texture unit; 0: estimated from the garment"});
    table.real("edge_length", f.edge_length,
               {.lower = 0, .upper = 1, .unit = "m", .doc = "refined until no edge is longer; 0: as it is"});
    table.real("clearance", f.clearance,
               {.lower = 0, .upper = 0.02, .unit = "m", .doc = "distance from the body it is pushed out to"});
    table.real("max_push", f.max_push,
               {.lower = 0, .upper = 0.1, .unit = "m", .doc = "deepest penetration that is pushed out"});
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
    if (garment.source != GarmentSource::file) garment.licence = "MIT, made by toile's code";
    table->text("licence", garment.licence, "under which the garment may be used, for the data card");
    switch (garment.source) {
        case GarmentSource::tshirt:
            return bind_tshirt(*table, garment.tshirt);
        case GarmentSource::patch:
            return bind_patch(*table, garment.patch);
        case GarmentSource::file:
            return bind_file(*table, garment);
    }
}

}  // namespace toile::generate

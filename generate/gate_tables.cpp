#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

namespace {

void bind_bounds(ConfigTable& table, simulate::GateOptions& g) {
    table.real("residual_force", g.residual_force,
               {.lower = 0, .upper = 1, .above = true, .doc = "net force over the garment's weight"});
    table.real("max_speed", g.max_speed, {.lower = 0, .upper = 10, .above = true, .unit = "m/s", .doc = "of a vertex"});
    table.real("moving_share", g.moving_share,
               {.lower = 0, .upper = 1, .doc = "of the vertices, faster than 0.018 m/s: 0.3 mm in a sixtieth second"});
    table.real("body_penetration", g.body_penetration,
               {.lower = 0, .upper = 0.1, .unit = "m", .doc = "deepest vertex below the body's mesh"});
    table.integer_or("body_crossings", g.body_crossings, "any",
                     {.lower = 0, .doc = "triangle pairs of cloth and body that meet"});
    table.integer_or("self_intersections", g.self_intersections, "any",
                     {.lower = 0, .doc = "triangle pairs of the cloth that meet"});
    table.real("max_stretch", g.max_stretch, {.lower = 1, .upper = 10, .doc = "edge length over rest length"});
}

}  // namespace

void bind_gate(ConfigTable& root, SceneConfig& config) {
    using simulate::GateProfile;
    ConfigTable table = root.section("gate", "what a drape must satisfy to be accepted");
    GateProfile profile = config.gate.profile;
    table.choice<GateProfile>(
        "profile", profile,
        {{"strict", GateProfile::strict}, {"paper", GateProfile::paper}, {"garmentcode", GateProfile::garmentcode}},
        "sets the bounds below, each of which can be given by itself");
    config.gate = simulate::gate_of(profile);
    bind_bounds(table, config.gate);
    ConfigTable ladder = root.section("ladder", "a drape that misses the gate is tried again, with more effort");
    ladder.integer("tries", config.ladder.tries,
                   {.lower = 0, .upper = simulate::rung_count - 1, .doc = "after the first"});
}

}  // namespace toile::generate

#include "generate/scene_tables.h"
#include "simulate/fabric.h"

namespace toile::generate {

using files::ConfigTable;

namespace {

/// The measured fabric whose values the other keys then start from, if one is named.
const simulate::Fabric* bind_preset(ConfigTable& table, simulate::MembraneOptions& membrane) {
    const simulate::Fabric* fabric = nullptr;
    files::ConfigChoices<const simulate::Fabric*> choices = {{"none", nullptr}};
    for (const simulate::Fabric& one : simulate::measured_fabrics()) choices.emplace_back(one.name, &one);
    table.choice("preset", fabric, choices, "a measured fabric; keys that are given go before its values");
    if (fabric) membrane = fabric->membrane;
    return fabric;
}

void bind_bending(ConfigTable& root, SceneConfig& config, const simulate::Fabric* fabric) {
    auto table = root.table("bending", "hinges between neighbouring triangles");
    if (!table) return;
    simulate::BendingOptions& b = config.bending.emplace();
    if (fabric) b.stiffness = fabric->bending_stiffness;
    table->real("stiffness", b.stiffness, {.lower = 0, .above = true, .unit = "N m", .doc = "bending rigidity"});
    table->choice<simulate::BendingRest>(
        "rest", b.rest, {{"flat", simulate::BendingRest::flat}, {"start", simulate::BendingRest::start}},
        "without moment in the flat pattern, or in the garment's starting shape");
}

void bind_material(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("material", "the cloth, per area of pattern");
    const simulate::Fabric* fabric = bind_preset(table, config.membrane);
    simulate::MembraneOptions& m = config.membrane;
    table.real("density_per_area", m.density_per_area, {.lower = 0.001, .upper = 100, .unit = "kg/m^2", .doc = "mass"});
    table.real("warp_stiffness", m.warp_stiffness,
               {.lower = 0, .above = true, .unit = "N/m", .doc = "against stretch along the pattern's v"});
    table.real("weft_stiffness", m.weft_stiffness,
               {.lower = 0, .above = true, .unit = "N/m", .doc = "against stretch along the pattern's u"});
    table.real("shear_stiffness", m.shear_stiffness,
               {.lower = 0, .above = true, .unit = "N/m", .doc = "against shear"});
    table.real("poisson_ratio", m.poisson_ratio, {.lower = 0, .upper = 0.49, .doc = "coupling of warp and weft"});
    table.choice<Compression>("compression", m.compression,
                              {{"full", Compression::full}, {"tension_field", Compression::tension_field}},
                              "against being squeezed; tension_field: none, the cloth wrinkles finer than its mesh");
    bind_bending(root, config, fabric);
    if (auto limit = root.table("strain_limit", "largest stretches, length over rest length")) {
        simulate::StrainLimitOptions& s = config.strain_limit.emplace();
        limit->real("warp", s.warp, {.lower = 1.001, .upper = 10, .doc = "along the pattern's v"});
        limit->real("weft", s.weft, {.lower = 1.001, .upper = 10, .doc = "along the pattern's u"});
    }
}

void bind_wind(ConfigTable& root, SceneConfig& config) {
    auto table = root.table("wind", "a steady, even wind");
    if (!table) return;
    simulate::WindOptions& w = config.wind.emplace();
    table->vector("velocity", w.velocity, {.lower = -100, .upper = 100, .unit = "m/s"});
    table->real("drag", w.drag, {.lower = 0, .upper = 10, .doc = "coefficient; 1.2 for a plate across the wind"});
    table->real("lift", w.lift, {.lower = 0, .upper = 10, .doc = "coefficient; that of drag makes a pressure"});
    table->real("air_density", w.air_density, {.lower = 0, .upper = 10, .unit = "kg/m^3"});
}

void bind_contact(ConfigTable& root, SceneConfig& config) {
    if (auto table = root.table("contact", "contact with the body, the table and the sphere")) {
        config.contact.emplace();
        table->real("thickness", config.contact->thickness,
                    {.lower = 0.0001, .upper = 0.02, .unit = "m", .doc = "distance the cloth keeps"});
        table->real("friction", config.contact->friction, {.lower = 0, .upper = 2, .doc = "Coulomb coefficient"});
    }
    if (auto table = root.table("table", "a horizontal plane, the cloth above it")) {
        config.table.emplace();
        table->real("height", config.table->height, {.lower = -1000, .upper = 1000, .unit = "m"});
    }
    if (auto table = root.table("sphere", "a fixed sphere")) {
        config.sphere.emplace();
        table->vector("center", config.sphere->center, {.lower = -1000, .upper = 1000, .unit = "m"});
        table->real("radius", config.sphere->radius, {.lower = 0, .upper = 1000, .above = true, .unit = "m"});
    }
    if (auto table = root.table("pins", "vertices held where they start")) {
        config.pins.emplace();
        table->integers("vertex", config.pins->vertex, {.lower = 0, .doc = "vertex indices"});
        table->choice<std::string>("corners", config.pins->corners, {{"none", ""}, {"top", "top"}},
                                   "top: the two upper corners of the pattern");
    }
}

void bind_self_contact(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("self_contact", "the cloth touches itself and never crosses itself");
    bool enabled = true;
    table.boolean("enabled", enabled, "false: layers pass through each other");
    if (!enabled) return;
    simulate::SelfContactOptions& s = config.self_contact.emplace();
    table.real("thickness", s.thickness,
               {.lower = 0.0001, .upper = 0.02, .unit = "m", .doc = "distance that layers keep"});
    table.real("friction", s.friction, {.lower = 0, .upper = 2, .doc = "Coulomb coefficient"});
}

void bind_level_set(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("level_set", "the body as a distance field");
    table.real("voxel", config.level_set.voxel, {.lower = 0.001, .upper = 0.02, .unit = "m", .doc = "grid spacing"});
    table.real("error_bound", config.level_set.error_bound,
               {.lower = 0.00001,
                .upper = 0.01,
                .unit = "m",
                .doc = "on the way to a pose rebuilt before the surface is off by three times this"});
}

void bind_solver(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("simulate", "the integrator, and what at rest means");
    simulate::SolverOptions& s = config.solver;
    table.choice<std::string>("solver", s.solver, {{"implicit", "implicit"}, {"xpbd", "xpbd"}, {"bullet", "bullet"}},
                              "implicit: implicit Euler by Newton's method; xpbd: extended position-based dynamics; "
                              "bullet: Bullet's soft body");
    table.real("time_step", s.time_step, {.lower = 0.0001, .upper = 0.2, .unit = "s", .doc = "while the cloth moves"});
    table.real("damping", s.damping,
               {.lower = 0, .upper = 1000, .unit = "1/s", .doc = "proportional to mass, relative to the moving body"});
    table.vector("gravity", s.gravity, {.lower = -1000, .upper = 1000, .unit = "m/s^2"});
    table.real("residual_tolerance", s.residual_tolerance,
               {.lower = 1e-9, .upper = 0.1, .doc = "net force over the garment's weight at rest"});
    table.real("speed_tolerance", s.speed_tolerance,
               {.lower = 0, .upper = 10, .above = true, .unit = "m/s", .doc = "largest vertex speed at rest"});
    table.integer("max_iterations", s.max_iterations,
                  {.lower = 1, .upper = 1000000, .doc = "iterations to come to rest"});
    table.integer("stall_iterations", s.stall_iterations,
                  {.lower = 1,
                   .upper = 1000000,
                   .doc = "gives up when these lower neither the residual by a tenth nor the energy"});
}

void bind_xpbd(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("xpbd", "extended position-based dynamics");
    simulate::XpbdOptions& x = config.solver.xpbd;
    table.integer("substeps", x.substeps, {.lower = 1, .upper = 10000, .doc = "small steps in one time step"});
    table.integer("iterations", x.iterations,
                  {.lower = 1, .upper = 1000, .doc = "sweeps over all constraints in a small step"});
    table.boolean("keep_forces", x.keep_forces,
                  "start from the last step's forces: rest is then exact whatever the step");
}

void bind_bullet(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("bullet", "Bullet's soft body");
    simulate::BulletOptions& b = config.solver.bullet;
    table.real("substep", b.substep,
               {.lower = 0.00001, .upper = 0.1, .unit = "s", .doc = "at most; a shorter one stretches less"});
    table.integer("position_iterations", b.position_iterations,
                  {.lower = 1, .upper = 1000, .doc = "passes over links and contacts in a substep"});
    table.integer("settle_substeps", b.settle_substeps,
                  {.lower = 1, .upper = 10000, .doc = "substeps in one settling step"});
}

void bind_path(ConfigTable& root, SceneConfig& config) {
    ConfigTable table = root.section("path", "the way from the neutral drape to a pose");
    simulate::ScheduleOptions& p = config.path;
    table.real("joint_step", p.joint_step,
               {.lower = 0.005, .upper = 1, .unit = "rad", .doc = "largest rotation of any joint in one step"});
    table.integer("path_iterations", p.path_iterations,
                  {.lower = 1, .upper = 100, .doc = "Newton iterations at most in one step"});
    table.real(
        "path_tolerance", p.path_tolerance,
        {.lower = 0, .upper = 0.1, .above = true, .unit = "m", .doc = "a step ends once no vertex moves further"});
}

}  // namespace

void bind_simulate(ConfigTable& root, SceneConfig& config) {
    bind_material(root, config);
    bind_wind(root, config);
    bind_contact(root, config);
    bind_self_contact(root, config);
    if (config.body || root.has("level_set")) bind_level_set(root, config);
    bind_solver(root, config);
    if (config.solver.solver == "xpbd" || root.has("xpbd")) bind_xpbd(root, config);
    if (config.solver.solver == "bullet" || root.has("bullet")) bind_bullet(root, config);
    if (config.body || root.has("path")) bind_path(root, config);
    bind_gate(root, config);
}

}  // namespace toile::generate

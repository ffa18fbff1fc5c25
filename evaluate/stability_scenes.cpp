#include "evaluate/stability_scenes.h"

#include "evaluate/case_meshes.h"
#include "pattern/tshirt.h"
#include "skin/anatomy.h"
#include "skin/builtin_body.h"
#include "skin/pillar_body.h"

namespace toile::evaluate {
namespace {

constexpr int cells = 20;        // along a square's side
constexpr double side = 0.6;     // of a square [m]
constexpr double unrest = 5e-4;  // starts are shaken by this, so that no symmetry holds a fold back [m]
constexpr std::uint64_t seed = 1;

StabilityScene square(double length, double height) {
    StabilityScene scene;
    const std::vector<double> lines = even_lines(cells, length);
    scene.drape.mesh = grid_cloth(lines, lines, height, scene.drape.membrane.density_per_area);
    shake(scene.drape.mesh.rest_position, unrest, seed);
    scene.drape.bending.emplace();
    scene.drape.self_contact.emplace();
    scene.drape.gate.max_stretch.reset();
    return scene;
}

/// Pins vertices of a square where it would be unshaken: pins further apart than the cloth between them is long would
/// strain it, by more than all else where it is stiff.
void pin(simulate::DrapeScene& scene, const std::vector<int>& vertices) {
    ClothMesh& mesh = scene.mesh;
    const double height = mesh.rest_position.col(1).mean(), half = 0.5 * mesh.pattern_position.maxCoeff();
    scene.pinned = vertices;
    for (const int v : vertices)
        mesh.rest_position.row(v) << mesh.pattern_position(v, 0) - half, height, half - mesh.pattern_position(v, 1);
}

void pin_far_corners(simulate::DrapeScene& scene) {
    const int last = scene.mesh.vertex_count() - 1;
    pin(scene, {last - cells, last});
}

void add_pillar(StabilityScene& scene, double angle) {
    scene.drape.contact.emplace();
    scene.drape.body = skin::pillar_body();
    scene.pose = skin::bent_pillar(angle);
}

}  // namespace

StabilityScene hanging_square() {
    StabilityScene scene = square(side, 1.0);
    pin_far_corners(scene.drape);
    return scene;
}

StabilityScene square_on_sphere() {
    StabilityScene scene = square(side, 0.53);
    scene.drape.contact.emplace();
    scene.drape.sphere = simulate::SphereOptions{{0.0, 0.3, 0.0}, 0.2};
    scene.drape.table = simulate::TableOptions{0.0};
    return scene;
}

StabilityScene leaning_square() {
    StabilityScene scene = square(side, 0.53);
    pin_far_corners(scene.drape);
    scene.drape.contact.emplace();
    scene.drape.sphere = simulate::SphereOptions{{0.05, 0.3, 0.0}, 0.2};
    return scene;
}

StabilityScene square_on_table() {
    StabilityScene scene = square(side, 0.02);
    scene.drape.contact.emplace();
    scene.drape.table = simulate::TableOptions{0.0};
    return scene;
}

StabilityScene square_on_pillar() {
    StabilityScene scene = square(0.4, 1.01);
    add_pillar(scene, 0.3);
    return scene;
}

StabilityScene struck_curtain() {
    StabilityScene scene = square(side, 0.0);
    Positions& x = scene.drape.mesh.rest_position;
    const int last = scene.drape.mesh.vertex_count() - 1;
    std::vector<int> top;
    for (int i = 0; i <= cells; ++i) top.push_back(last - i);
    pin(scene.drape, top);
    // The level square, turned to hang in the plane x = -0.2 before the pillar's head.
    const Positions level = x;
    x.col(0) = level.col(1).array() - 0.2;
    x.col(1) = 1.0 - level.col(2).array();
    x.col(2) = -level.col(0);
    add_pillar(scene, 0.8);
    return scene;
}

StabilityScene tshirt() {
    // Made once: the body and the shirt cut to it take longer than most drapes.
    static const StabilityScene made = [] {
        StabilityScene scene;
        simulate::DrapeScene& drape = scene.drape;
        drape.body = skin::make_builtin_body({});
        pattern::TshirtOptions options;
        options.edge_length = 0.04;
        drape.mesh = pattern::make_tshirt(*drape.body, options).mesh;
        drape.mesh.mass = lumped_mass(drape.mesh, drape.membrane.density_per_area);
        drape.bending.emplace();
        drape.contact.emplace();
        drape.self_contact.emplace();
        drape.gate.max_stretch.reset();
        skin::RoleAngles raised;
        raised.angle[skin::Role::left_upper_arm] = {0.9, 0.0, 0.0};
        raised.angle[skin::Role::right_upper_arm] = {0.4, 0.3, 0.0};
        scene.pose = skin::pose_from_angles(*drape.body, raised);
        return scene;
    }();
    return made;
}

}  // namespace toile::evaluate

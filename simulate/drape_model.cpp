#include "simulate/drape_model.h"

#include <algorithm>
#include <string>

#include "cloth/error.h"
#include "simulate/certificate.h"

namespace toile::simulate {
namespace {

/// The contact pressure where cloth touches a surface is the largest of: the membrane's stiffness over this length [m]
/// (a garment stretched by a tenth around a limb then stays clear of it), ...
constexpr double membrane_length = 0.05;
/// ... bending stiffness over this length's cube [m] (stiff cloth bent around an edge), ...
constexpr double bending_length = 0.02;
/// ... and the cloth's weight per area this many times: a garment hangs on its shoulders.
constexpr double borne_layers = 100.0;
constexpr double standard_gravity = 9.81;  // [m/s^2]; weightless scenes are measured against it

double contact_pressure(const DrapeScene& scene) {
    const MembraneOptions& membrane = scene.membrane;
    const double gravity = std::max(scene.solver.gravity.norm(), standard_gravity);
    const double bending = scene.bending ? scene.bending->stiffness : 0.0;
    return std::max({std::max(membrane.warp_stiffness, membrane.weft_stiffness) / membrane_length,
                     bending / (bending_length * bending_length * bending_length),
                     borne_layers * membrane.density_per_area * gravity});
}

/// The scene, if it can be draped.
const DrapeScene& checked(const DrapeScene& scene) {
    check_cloth_mesh(scene.mesh, "garment");
    if (scene.mesh.mass.size() != scene.mesh.vertex_count() || !(scene.mesh.mass.minCoeff() > 0.0))
        throw Error("every vertex of a garment to be draped needs a mass above 0");
    const bool touches = scene.body || scene.table || scene.sphere;
    if (touches && !scene.contact) throw Error("a scene with a body, a table or a sphere needs contact");
    if (scene.solver.solver == "bullet") {
        const std::string unknown = " is unknown to the solver \"bullet\"";
        if (scene.strain_limit) throw Error("a strain limit" + unknown);
        if (scene.membrane.compression == Compression::tension_field) throw Error("a tension field" + unknown);
    }
    for (int v : scene.pinned)
        if (v < 0 || v >= scene.mesh.vertex_count())
            throw Error("pinned vertex " + std::to_string(v) + " does not exist");
    return scene;
}

}  // namespace

DrapeModel::DrapeModel(const DrapeScene& from)
    : scene(checked(from)),
      topology(build_topology(scene.mesh.triangle)),
      rest_length(edge_rest_lengths(scene.mesh, topology)),
      elasticity(scene.mesh, topology, scene.membrane, scene.bending, scene.solver.gravity, scene.strain_limit),
      symbolic(std::make_shared<const BlockSymbolic>(scene.mesh.vertex_count(), elasticity.pairs())) {
    elasticity.bind(*symbolic);
    if (scene.contact) points = contact_points(scene.mesh, topology, *symbolic);
    if (scene.contact || scene.self_contact) pressure = contact_pressure(scene);
    if (scene.body) {
        const skin::Pose pose = skin::Pose::Zero(scene.body->joint_count(), 3);
        neutral = std::make_shared<const BodyLevelSet>(
            *scene.body, skin::skin_positions(*scene.body, pose, scene.skinning), scene.mesh.rest_position,
            scene.level_set.voxel, scene.contact->thickness);
    }
    const double gravity = scene.solver.gravity.norm();
    weight = scene.mesh.mass.sum() * (gravity > 0.0 ? gravity : standard_gravity);
}

}  // namespace toile::simulate

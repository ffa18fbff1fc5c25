#include "evaluate/stability_cases.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "evaluate/case_meshes.h"
#include "skin/skinning.h"

namespace toile::evaluate {
namespace {

using Base = StabilityScene (*)();
using Change = std::function<void(StabilityScene&)>;
using Cases = std::vector<StabilityCase>;

constexpr std::uint64_t seed = 2;

struct NamedBase {
    const char* name;
    Base make;
    bool quick;
};
constexpr NamedBase hanging{"hanging", hanging_square, true};
constexpr NamedBase on_sphere{"on a sphere", square_on_sphere, true};
constexpr NamedBase leaning{"leaning on a sphere", leaning_square, true};
constexpr NamedBase on_table{"on a table", square_on_table, true};
constexpr NamedBase on_pillar{"on a bending pillar", square_on_pillar, false};
constexpr NamedBase curtain{"curtain struck by a pillar", struck_curtain, false};
constexpr NamedBase shirt{"T-shirt", tshirt, false};

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

void add(Cases& cases, const std::string& group, const std::string& what, const NamedBase& base, bool quick,
         const Change& change) {
    cases.push_back({group, what + ", " + base.name, quick && base.quick, [make = base.make, change] {
                         StabilityScene scene = make();
                         change(scene);
                         return scene;
                     }});
}

/// One case for each value; the first and the last are quick.
void add_sweep(Cases& cases, const std::string& group, const std::string& unit, const std::vector<double>& values,
               const NamedBase& base, const std::function<void(StabilityScene&, double)>& change) {
    for (const double value : values)
        add(cases, group, group + " " + number(value) + unit, base, value == values.front() || value == values.back(),
            [change, value](StabilityScene& scene) { change(scene, value); });
}

void scale_membrane(StabilityScene& scene, double factor) {
    simulate::MembraneOptions& membrane = scene.drape.membrane;
    membrane.warp_stiffness *= factor;
    membrane.weft_stiffness *= factor;
    membrane.shear_stiffness *= factor;
}

void scale_bending(StabilityScene& scene, double factor) {
    scene.drape.bending->stiffness *= factor;
}

void set_density(StabilityScene& scene, double density) {
    simulate::MembraneOptions& membrane = scene.drape.membrane;
    scene.drape.mesh.mass *= density / membrane.density_per_area;
    membrane.density_per_area = density;
}

void set_time_step(StabilityScene& scene, double time_step) {
    scene.drape.solver.time_step = time_step;
}

void set_friction(StabilityScene& scene, double friction) {
    scene.drape.contact->friction = friction;
}

/// Steps of the path so long that the body's fastest vertex moves at this speed [m/s].
void set_body_speed(StabilityScene& scene, double speed) {
    simulate::DrapeScene& drape = scene.drape;
    constexpr double share = 0.01;
    const skin::Pose neutral = skin::Pose::Zero(scene.pose->rows(), 3);
    const skin::Pose near = skin::interpolate(neutral, *scene.pose, share);
    const Positions moved = skin::skin_positions(*drape.body, near, drape.skinning);
    const double way = (moved - drape.body->rest_position).rowwise().norm().maxCoeff();
    const double metres_per_radian = way / skin::largest_joint_rotation(neutral, near);
    drape.schedule.joint_step = speed * drape.solver.time_step / metres_per_radian;
}

/// Left is right, and the outside is within.
void mirror(StabilityScene& scene) {
    scene.drape.mesh.rest_position.col(0) *= -1.0;
}

double mean_edge(const ClothMesh& mesh) {
    double sum = 0.0;
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int c = 0; c < 3; ++c)
            sum += (mesh.rest_position.row(mesh.triangle(f, c)) - mesh.rest_position.row(mesh.triangle(f, (c + 1) % 3)))
                       .norm();
    return sum / (3.0 * mesh.triangle_count());
}

void crumple(StabilityScene& scene, double edges) {
    Positions& x = scene.drape.mesh.rest_position;
    const Positions before = x;
    shake(x, edges * mean_edge(scene.drape.mesh), seed);
    for (const int v : scene.drape.pinned) x.row(v) = before.row(v);
}

/// Pulled in towards its middle and shaken: folds everywhere.
void squeeze(StabilityScene& scene, double share) {
    Positions& x = scene.drape.mesh.rest_position;
    const Eigen::RowVector3d middle = x.colwise().mean();
    x = ((x.rowwise() - middle) * share).rowwise() + middle;
    shake(x, 0.25 * share * mean_edge(scene.drape.mesh), seed);
}

/// Thinner about the vertical axis: a garment then starts inside the body.
void shrink_sideways(StabilityScene& scene, double share) {
    Positions& x = scene.drape.mesh.rest_position;
    x.col(0) *= share;
    x.col(2) *= share;
}

void displace_middle(StabilityScene& scene, const Eigen::RowVector3d& by) {
    Positions& x = scene.drape.mesh.rest_position;
    x.row(x.rows() / 2) += by;
}

/// The same scene with another cloth at the same height.
void replace_cloth(StabilityScene& scene, ClothMesh mesh) {
    scene.drape.mesh = std::move(mesh);
    shake(scene.drape.mesh.rest_position, 1e-5, seed);
}

/// A grid whose lines lie 50 mm apart, but for two pairs in either direction that are a thousand times nearer.
ClothMesh needle_cloth(double height, double density_per_area) {
    constexpr double cell = 0.05;
    std::vector<double> line = even_lines(12, 12 * cell);
    for (const int k : {4, 7}) line.push_back(k * cell + 0.001 * cell);
    std::sort(line.begin(), line.end());
    return grid_cloth(line, line, height, density_per_area);
}

void add_materials(Cases& cases) {
    const std::vector<double> factors{1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3, 1e4, 1e5};
    for (const NamedBase& base : {hanging, on_sphere})
        add_sweep(cases, "membrane stiffness", " x", factors, base, scale_membrane);
    add_sweep(cases, "membrane stiffness", " x", {1e-3, 1e2, 1e5}, shirt, scale_membrane);
    for (const NamedBase& base : {hanging, on_sphere})
        add_sweep(cases, "bending stiffness", " x", factors, base, scale_bending);
    add_sweep(cases, "bending stiffness", " x", {1e-3, 1e2, 1e5}, shirt, scale_bending);
    for (const NamedBase& base : {hanging, on_sphere})
        add_sweep(cases, "density", " kg/m^2", {0.01, 0.1, 1.0, 10.0}, base, set_density);
    add_sweep(cases, "density", " kg/m^2", {0.01, 10.0}, shirt, set_density);
}

void add_motion(Cases& cases) {
    const std::vector<double> steps{0.001, 0.003, 0.01, 0.03, 0.1};
    for (const NamedBase& base : {hanging, leaning, on_pillar})
        add_sweep(cases, "time step", " s", steps, base, set_time_step);
    add_sweep(cases, "time step", " s", {0.001, 0.1}, shirt, set_time_step);
    for (const NamedBase& base : {leaning, on_table, shirt})
        add_sweep(cases, "friction", "", {0.0, 0.3, 1.0, 2.0}, base, set_friction);
    for (const NamedBase& base : {on_pillar, curtain, shirt})
        add_sweep(cases, "body speed", " m/s", {1.0, 10.0}, base, set_body_speed);
    add(cases, "body speed", "body speed 10 m/s in steps of 1/100 s", shirt, false, [](StabilityScene& scene) {
        set_time_step(scene, 0.01);
        set_body_speed(scene, 10.0);
    });
}

void add_starts(Cases& cases) {
    for (const NamedBase& base : {hanging, on_sphere, shirt}) add(cases, "start", "inverted", base, true, mirror);
    for (const double edges : {0.25, 1.0})
        for (const NamedBase& base : {hanging, on_sphere, shirt})
            add(cases, "start", "crumpled by " + number(edges) + " edges", base, true,
                [edges](StabilityScene& scene) { crumple(scene, edges); });
    add(cases, "start", "squeezed to a third", on_table, true, [](StabilityScene& scene) { squeeze(scene, 1.0 / 3); });
    for (const double depth : {0.05, 0.15})
        add(cases, "start", number(depth) + " m inside", on_sphere, true,
            [depth](StabilityScene& scene) { scene.drape.mesh.rest_position.col(1).array() -= 0.03 + depth; });
    add(cases, "start", "0.03 m inside", on_pillar, false,
        [](StabilityScene& scene) { scene.drape.mesh.rest_position.col(1).array() -= 0.04; });
    add(cases, "start", "shrunk by a fifth into the body", shirt, false,
        [](StabilityScene& scene) { shrink_sideways(scene, 0.8); });
    add(cases, "start", "one vertex a metre up", hanging, true, [](StabilityScene& scene) {
        displace_middle(scene, {0, 1, 0});
    });
    add(cases, "start", "one vertex a metre aside", on_table, true, [](StabilityScene& scene) {
        displace_middle(scene, {1, 0, 0});
    });
    add(cases, "start", "one vertex a metre down, through the sphere", on_sphere, true, [](StabilityScene& scene) {
        displace_middle(scene, {0, -1, 0});
    });
    add(cases, "start", "one vertex a metre ahead", shirt, false, [](StabilityScene& scene) {
        displace_middle(scene, {0, 0, 1});
    });
}

void add_meshes(Cases& cases) {
    const auto needles = [](StabilityScene& scene) {
        const double height = scene.drape.mesh.rest_position.col(1).mean();
        replace_cloth(scene, needle_cloth(height, scene.drape.membrane.density_per_area));
    };
    const auto graded = [](StabilityScene& scene) {
        const double height = scene.drape.mesh.rest_position.col(1).mean();
        replace_cloth(scene, graded_disc(24, 0.01, 0.3, height, scene.drape.membrane.density_per_area));
    };
    add(cases, "mesh", "triangles of aspect 1000", hanging, true, [needles](StabilityScene& scene) {
        needles(scene);
        const int last = scene.drape.mesh.vertex_count() - 1;
        scene.drape.pinned = {last - 14, last};  // a row holds 15 vertices
    });
    add(cases, "mesh", "edges from 1 to 30 in one mesh", hanging, true, [graded](StabilityScene& scene) {
        graded(scene);
        scene.drape.pinned = {0, scene.drape.mesh.vertex_count() - 1};
    });
    for (const NamedBase& base : {on_sphere, on_table}) {
        add(cases, "mesh", "triangles of aspect 1000", base, true, needles);
        add(cases, "mesh", "edges from 1 to 30 in one mesh", base, true, graded);
    }
}

}  // namespace

std::vector<StabilityCase> stability_cases() {
    Cases cases;
    add_materials(cases);
    add_motion(cases);
    add_starts(cases);
    add_meshes(cases);
    return cases;
}

}  // namespace toile::evaluate

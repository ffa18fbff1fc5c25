#include "generate/scene.h"

#include <algorithm>
#include <cmath>

#include "cloth/error.h"
#include "skin/arm_clearance.h"
#include "skin/motion_poses.h"
#include "skin/pose_table.h"

namespace toile::generate {
namespace {

skin::RiggedBody build_body(const BodyConfig& config) {
    if (config.builtin) return {skin::make_builtin_body(config.builtin_options), {}};
    return skin::read_rigged_body(config.file.resolved, config.rigged_options);
}

std::unique_ptr<skin::PoseSource> build_poses(const SceneConfig& config, const skin::Body& body,
                                              std::vector<std::string>& remarks) {
    const PosesConfig& poses = *config.poses;
    switch (poses.source) {
        case PoseSource::sampler:
            return std::make_unique<skin::SampledPoses>(skin::PoseSampler(body, poses.sampler, config.file + ":poses"),
                                                        poses.count);
        case PoseSource::bvh: {
            skin::MotionPoses motion = skin::read_motion_poses(body, poses.file.resolved, poses.motion);
            remarks.insert(remarks.end(), motion.fit.remarks.begin(), motion.fit.remarks.end());
            return std::make_unique<skin::PoseList>(std::move(motion.poses));
        }
        case PoseSource::table:
            return std::make_unique<skin::PoseList>(skin::read_pose_table(body, poses.file.resolved));
    }
    throw Error("unknown pose source", config.file + ":poses.source");
}

pattern::Garment build_garment(const SceneConfig& config, const std::optional<skin::Body>& body) {
    const GarmentConfig& garment = config.garment;
    switch (garment.source) {
        case GarmentSource::tshirt:
            return pattern::make_tshirt(*body, garment.tshirt);
        case GarmentSource::patch:
            return pattern::make_patch(garment.patch);
        case GarmentSource::file:
            return pattern::read_garment(garment.file.resolved, garment.file_options, body ? &*body : nullptr);
    }
    throw Error("unknown garment source", config.file + ":garment.source");
}

/// The two vertices whose pattern positions are highest at either side.
std::vector<int> top_corners(const ClothMesh& mesh) {
    int left = 0, right = 0;
    const auto score = [&](int p, double side) {
        return mesh.pattern_position(p, 1) + side * mesh.pattern_position(p, 0);
    };
    for (int p = 1; p < mesh.pattern_position.rows(); ++p) {
        if (score(p, -1) > score(left, -1)) left = p;
        if (score(p, 1) > score(right, 1)) right = p;
    }
    std::vector<int> vertex;
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int p = mesh.pattern_triangle(f, corner);
            if (p == left || p == right) vertex.push_back(mesh.triangle(f, corner));
        }
    std::sort(vertex.begin(), vertex.end());
    vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
    return vertex;
}

std::vector<int> pinned_vertices(const SceneConfig& config, const ClothMesh& mesh) {
    if (!config.pins) return {};
    std::vector<int> vertex = config.pins->vertex;
    for (const int one : vertex)
        if (one < 0 || one >= mesh.vertex_count())
            throw Error("pins.vertex names vertex " + std::to_string(one) + ", the garment has " +
                            std::to_string(mesh.vertex_count()) + " vertices",
                        config.file + ":pins.vertex");
    if (config.pins->corners == "top")
        for (const int one : top_corners(mesh)) vertex.push_back(one);
    std::sort(vertex.begin(), vertex.end());
    vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
    return vertex;
}

}  // namespace

Scene build_posed_body(const SceneConfig& config) {
    Scene scene;
    scene.config = config;
    if (!config.body) return scene;
    skin::RiggedBody rigged = build_body(*config.body);
    scene.body = std::move(rigged.body);
    scene.remarks = std::move(rigged.remarks);
    if (!config.poses) return scene;
    scene.poses = build_poses(config, *scene.body, scene.remarks);
    if (const double gap = config.poses->arm_clearance; gap > 0.0) {
        scene.poses =
            std::make_unique<skin::ClearedPoses>(std::move(scene.poses), *scene.body, config.body->skinning, gap);
        scene.remarks.push_back("arms that come nearer to the trunk than " + std::to_string(std::lround(1000.0 * gap)) +
                                " mm are turned away from it (poses.arm_clearance)");
    }
    scene.pose_number = skin::selected_numbers(*scene.poses, config.poses->selection, config.file + ":poses.number");
    return scene;
}

Scene build_scene(const SceneConfig& config) {
    Scene scene = build_posed_body(config);
    try {
        scene.garment = build_garment(config, scene.body);
    } catch (const Error& error) {
        if (!error.where().empty()) throw;
        throw Error(error.what(), config.file + ":garment", error.mend());
    }
    scene.garment.mesh.mass = lumped_mass(scene.garment.mesh, config.membrane.density_per_area);
    scene.remarks.insert(scene.remarks.end(), scene.garment.remarks.begin(), scene.garment.remarks.end());
    scene.pinned = pinned_vertices(config, scene.garment.mesh);
    return scene;
}

std::unique_ptr<simulate::Draper> make_draper(const Scene& scene) {
    const SceneConfig& config = scene.config;
    simulate::DrapeScene drape;
    drape.mesh = scene.garment.mesh;
    drape.membrane = config.membrane;
    drape.bending = config.bending;
    drape.strain_limit = config.strain_limit;
    drape.wind = config.wind;
    drape.contact = config.contact;
    drape.self_contact = config.self_contact;
    drape.body = scene.body;
    if (config.body) drape.skinning = config.body->skinning;
    drape.level_set = config.level_set;
    drape.table = config.table;
    drape.sphere = config.sphere;
    drape.pinned = scene.pinned;
    drape.solver = config.solver;
    drape.schedule = config.path;
    drape.gate = config.gate;
    drape.ladder = config.ladder;
    return std::make_unique<simulate::Draper>(drape);
}

DressedScene dress(Scene scene) {
    simulate::DrapeResult neutral = make_draper(scene)->drape_neutral();
    const std::string reason(simulate::status_reason(neutral.status));
    if (neutral.status == simulate::DrapeStatus::not_finite)
        throw Error("the garment cannot be draped in the neutral pose: " + reason, scene.config.file,
                    "check the material, and that the garment fits the body");
    if (neutral.status != simulate::DrapeStatus::accepted)
        scene.remarks.push_back("the drape in the neutral pose, where all others start, is itself not accepted: " +
                                reason + "; toile simulate shows it and its certificate");
    return dress_again(std::move(scene), neutral.position);
}

DressedScene dress_again(Scene scene, const Positions& neutral) {
    if (neutral.rows() != scene.garment.mesh.vertex_count())
        throw Error("the neutral drape has " + std::to_string(neutral.rows()) + " vertices, the garment " +
                        std::to_string(scene.garment.mesh.vertex_count()),
                    scene.config.file, "a file that the configuration names has changed: begin in another folder");
    DressedScene dressed;
    dressed.scene = std::move(scene);
    dressed.draper = make_draper(dressed.scene);
    dressed.mesh = dressed.scene.garment.mesh;
    dressed.mesh.rest_position = neutral;
    if (dressed.scene.body) dressed.embedding = pattern::embed(dressed.mesh, *dressed.scene.body);
    return dressed;
}

}  // namespace toile::generate

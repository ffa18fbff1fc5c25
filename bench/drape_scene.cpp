#include "bench/drape_scene.h"

#include <cmath>

#include "pattern/patch.h"
#include "pattern/tshirt.h"
#include "skin/builtin_body.h"
#include "skin/pose_sampler.h"

namespace toile::bench {

std::vector<DrapeSize> drape_sizes(bool large) {
    std::vector<DrapeSize> size{{"1000", 0.0300}, {table_size, 0.0175}, {"10000", 0.0096}};
    if (large) size.push_back({"25000", 0.0060});
    return size;
}

simulate::DrapeScene shirt_scene(double edge_length) {
    static const skin::Body body = skin::make_builtin_body({});
    pattern::TshirtOptions options;
    options.edge_length = edge_length;
    simulate::DrapeScene scene;
    scene.body = body;
    scene.mesh = pattern::make_tshirt(body, options).mesh;
    scene.mesh.mass = lumped_mass(scene.mesh, scene.membrane.density_per_area);
    scene.bending.emplace();
    scene.contact.emplace();
    scene.self_contact.emplace();
    return scene;
}

std::vector<skin::Pose> arm_poses(const skin::Body& body, int count) {
    skin::SamplerOptions options;
    options.seed = 1;
    options.roles = {skin::Role::left_upper_arm, skin::Role::right_upper_arm, skin::Role::left_lower_arm,
                     skin::Role::right_lower_arm};
    const skin::PoseSampler sampler(body, options);
    std::vector<skin::Pose> pose;
    for (int k = 0; k < count; ++k) pose.push_back(sampler.pose(k));
    return pose;
}

simulate::DrapeScene patch_scene(int vertices) {
    pattern::PatchOptions options;
    options.orientation = pattern::PatchOrientation::horizontal;
    options.edge_length = std::sqrt(1.15 * options.width * options.height / vertices);
    simulate::DrapeScene scene;
    scene.mesh = pattern::make_patch(options).mesh;
    scene.mesh.mass = lumped_mass(scene.mesh, scene.membrane.density_per_area);
    scene.bending.emplace();
    scene.self_contact.emplace();
    // The two upper corners of the pattern.
    Eigen::Index left = 0, right = 0;
    const PlanePositions& flat = scene.mesh.pattern_position;
    (flat.col(1) - flat.col(0)).maxCoeff(&left);
    (flat.col(1) + flat.col(0)).maxCoeff(&right);
    for (int f = 0; f < scene.mesh.triangle_count(); ++f)
        for (int c = 0; c < 3; ++c)
            if (scene.mesh.pattern_triangle(f, c) == left || scene.mesh.pattern_triangle(f, c) == right)
                scene.pinned.push_back(scene.mesh.triangle(f, c));
    return scene;
}

}  // namespace toile::bench

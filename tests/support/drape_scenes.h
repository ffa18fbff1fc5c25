#pragma once

#include "simulate/drape.h"
#include "skin/pillar_body.h"
#include "tests/simulate/cloth_square.h"

namespace toile::test {

/// A square of n x n cells, hung by two corners of one side (v = side), that starts level and a little crumpled.
inline simulate::DrapeScene hanging_square(int n, double side) {
    simulate::DrapeScene scene;
    scene.mesh = cloth_square(n, side, 1.0);
    scene.mesh.rest_position = crumpled(scene.mesh.rest_position, 0.0005);
    scene.bending.emplace();
    scene.pinned = {n * (n + 1), n * (n + 1) + n};
    return scene;
}

/// A square of n x n cells on top of the pillar.
inline simulate::DrapeScene square_on_pillar(int n) {
    simulate::DrapeScene scene;
    scene.mesh = cloth_square(n, 0.3, 1.01);
    scene.mesh.rest_position = crumpled(scene.mesh.rest_position, 0.0005);
    scene.bending.emplace();
    scene.contact.emplace();
    scene.body = skin::pillar_body();
    scene.level_set.voxel = 0.008;
    return scene;
}

}  // namespace toile::test

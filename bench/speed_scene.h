#pragma once

#include <vector>

#include "cloth/cloth_mesh.h"
#include "prior/rest_state.h"

namespace toile::bench {

/// What the speed table is measured on: an open tube with edges of 15 mm, as a shirt has them, and predictions of a
/// bent tube that are off by 1 to 30 mm (root mean square, evenly in the logarithm over the samples; a twentieth of the
/// error's square is white noise, the rest smooth): half of the edges are longer than they may be.
struct SpeedScene {
    ClothMesh mesh;
    prior::RestState rest;
    int samples = 0;
    std::vector<double> predicted;      ///< `[N x V x 3]` [m]
    std::vector<double> moved;          ///< the same predictions after a step of training: off by a hundredth more
    std::vector<double> loss_gradient;  ///< `[N x V x 3]`

    /// Share of the edges of all samples that are longer than at rest.
    double overstretched_share() const;
};

/// `around * along` vertices. 53 x 56 has the 2,968 vertices and 8,798 edges of the issue.
SpeedScene speed_scene(int around, int along, int samples);

}  // namespace toile::bench

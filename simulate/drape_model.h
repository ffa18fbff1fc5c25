#pragma once

#include <memory>
#include <vector>

#include "cloth/block_symbolic.h"
#include "cloth/topology.h"
#include "simulate/collision_body.h"
#include "simulate/contact.h"
#include "simulate/drape.h"
#include "simulate/elasticity.h"

namespace toile::simulate {

/// What all drapes of one scene share: built once, then read by every thread.
struct DrapeModel {
    DrapeScene scene;
    Topology topology;
    Eigen::VectorXd rest_length;  ///< `[E]` [m]
    Elasticity elasticity;
    std::shared_ptr<const BlockSymbolic> symbolic;  ///< of the Hessian
    std::vector<ContactPoint> points;               ///< empty without contact
    std::shared_ptr<const BodyLevelSet> neutral;    ///< in the neutral pose; none without a body
    double pressure = 0.0;                          ///< of contact where cloth touches [Pa]
    double weight = 0.0;                            ///< of the garment [N]

    /// Throws Error for a mesh that cannot be draped, missing masses, contact that is wanted but absent, unknown pinned
    /// vertices.
    explicit DrapeModel(const DrapeScene& from);
    DrapeModel(const DrapeModel&) = delete;  // its parts refer to its scene
    DrapeModel& operator=(const DrapeModel&) = delete;
};

}  // namespace toile::simulate

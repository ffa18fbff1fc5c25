#pragma once

#include <string>
#include <vector>

#include "simulate/drape.h"
#include "skin/pose.h"

namespace toile::bench {

/// A size of the built-in T-shirt.
struct DrapeSize {
    std::string name;    ///< "3000"
    double edge_length;  ///< [m]
};
/// About 1,000, 3,000 and 10,000 vertices, and with `large` the finest that the pattern allows, about 25,000.
std::vector<DrapeSize> drape_sizes(bool large);
inline const std::string table_size = "3000";  ///< the size that everything but scaling is measured at

/// The built-in T-shirt on the built-in body, as configs/tshirt.toml has it: default material, contact, the default
/// gate.
simulate::DrapeScene shirt_scene(double edge_length);

/// Poses over the whole range of both arms, the same each time.
std::vector<skin::Pose> arm_poses(const skin::Body& body, int count);

/// A square that starts level and swings down from two corners, of about as many vertices as the shirt: no body, no
/// contact with one.
simulate::DrapeScene patch_scene(int vertices);

}  // namespace toile::bench

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "skin/pose.h"

namespace toile::skin {

/// Two poses that are nearly the same and in different splits.
struct SplitLeak {
    std::int64_t pose, other;  ///< `other` is the first such before `pose`
};

/// Every pose before which there is one of another split nearer than `angle` [rad] in every joint, in order. `pose(k)`
/// gives pose k of split `split[k]` >= 0; poses that are not finite are near nothing. Poses are asked for in order and,
/// where they may be near, again; what is kept of each is some 60 bytes (`PoseGrid`).
std::vector<SplitLeak> split_leaks(const std::function<Pose(std::int64_t)>& pose, const std::vector<std::int8_t>& split,
                                   double angle);

}  // namespace toile::skin

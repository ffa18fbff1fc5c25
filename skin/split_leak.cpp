#include "skin/split_leak.h"

#include <algorithm>
#include <set>

#include "skin/pose_grid.h"

namespace toile::skin {

std::vector<SplitLeak> split_leaks(const std::function<Pose(std::int64_t)>& pose, const std::vector<std::int8_t>& split,
                                   double angle) {
    std::vector<SplitLeak> leak;
    const std::set<std::int8_t> layers(split.begin(), split.end());
    if (layers.size() < 2 || !(angle > 0)) return leak;
    const auto count = static_cast<std::int64_t>(split.size());
    PoseGrid grid(pose, count, angle);
    std::vector<std::int64_t> number;  // of the poses in the grid
    std::vector<std::int32_t> candidate;
    for (std::int64_t k = 0; k < count; ++k) {
        const Pose one = pose(k);
        if (one.rows() == 0 || !one.allFinite()) continue;
        const PoseGrid::Coordinates at = grid.coordinates(one);
        candidate.clear();
        for (const std::int8_t layer : layers)
            if (layer != split[static_cast<std::size_t>(k)]) grid.find(at, layer, candidate);
        std::sort(candidate.begin(), candidate.end());
        const auto near = std::find_if(candidate.begin(), candidate.end(), [&](std::int32_t entry) {
            return largest_joint_rotation(pose(number[entry]), one) < angle;
        });
        if (near != candidate.end()) leak.push_back({k, number[*near]});
        grid.insert(at, split[static_cast<std::size_t>(k)]);
        number.push_back(k);
    }
    return leak;
}

}  // namespace toile::skin

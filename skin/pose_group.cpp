#include "skin/pose_group.h"

#include <algorithm>
#include <optional>

#include "skin/pose_grid.h"

namespace toile::skin {
namespace {

struct Kept {
    std::int64_t number;
    std::int64_t group;
};

}  // namespace

struct PoseGroups::Impl {
    Impl(Source source, std::int64_t poses, double duplicate_angle) : pose(std::move(source)), angle(duplicate_angle) {
        if (angle > 0) grid.emplace(pose, poses, angle);
    }
    Source pose;
    double angle;
    std::optional<PoseGrid> grid;
    std::int64_t number = 0, groups = 0;  ///< poses placed, groups founded
    std::vector<Kept> kept;               ///< those in the grid
    std::vector<std::int32_t> candidate;
};

PoseGroups::PoseGroups(Source pose, std::int64_t count, double angle)
    : impl_(std::make_unique<Impl>(std::move(pose), count, angle)) {}
PoseGroups::~PoseGroups() = default;

PoseGroups::Place PoseGroups::next() {
    Impl& m = *impl_;
    const std::int64_t number = m.number++;
    if (!(m.angle > 0)) return {m.groups++, true, {}};
    const Pose pose = m.pose(number);
    const PoseGrid::Coordinates at = m.grid->coordinates(pose);
    m.candidate.clear();
    m.grid->find(at, 0, m.candidate);
    std::sort(m.candidate.begin(), m.candidate.end());
    m.candidate.erase(std::unique(m.candidate.begin(), m.candidate.end()), m.candidate.end());
    Place place;
    double nearest = m.angle;
    for (const std::int32_t k : m.candidate) {
        const double distance = largest_joint_rotation(m.pose(m.kept[k].number), pose);
        if (!(distance < m.angle)) continue;
        if (place.near.empty()) place.group = m.kept[k].group;
        place.near.push_back(m.kept[k].group);
        nearest = std::min(nearest, distance);
    }
    place.founds = place.near.empty();
    if (place.founds) place.group = m.groups++;
    if (nearest >= m.angle / 2) {
        m.grid->insert(at);
        m.kept.push_back({number, place.group});
    }
    return place;
}

}  // namespace toile::skin

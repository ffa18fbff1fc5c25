#include "simulate/body_parts.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "skin/skinning.h"

namespace toile::simulate {
namespace {

/// How far an arm's part goes on over the trunk, along the surface [m]: deeper than cloth is pushed.
constexpr double border = 0.025;

/// Vertices that one joint, or those below it, hold most of.
std::vector<bool> held_by(const skin::Body& body, int top) {
    const std::vector<bool> below = skin::joints_below(body, top);
    std::vector<bool> held(static_cast<size_t>(body.vertex_count()));
    for (int v = 0; v < body.vertex_count(); ++v) held[v] = below[skin::heaviest_joint(body.weight, v)];
    return held;
}

std::vector<std::vector<std::pair<int, double>>> neighbours_of(const skin::Body& body) {
    std::vector<std::vector<std::pair<int, double>>> neighbour(static_cast<size_t>(body.vertex_count()));
    for (int f = 0; f < body.triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int a = body.triangle(f, corner), b = body.triangle(f, (corner + 1) % 3);
            const double length = (body.rest_position.row(a) - body.rest_position.row(b)).norm();
            neighbour[a].emplace_back(b, length);
            neighbour[b].emplace_back(a, length);
        }
    return neighbour;
}

/// `held` and all vertices within `border` of it along edges.
std::vector<bool> widened(const std::vector<std::vector<std::pair<int, double>>>& neighbour,
                          const std::vector<bool>& held) {
    std::vector<double> distance(held.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (size_t v = 0; v < held.size(); ++v)
        if (held[v]) queue.emplace(distance[v] = 0.0, static_cast<int>(v));
    while (!queue.empty()) {
        const auto [so_far, v] = queue.top();
        queue.pop();
        if (so_far > distance[v]) continue;
        for (const auto& [other, length] : neighbour[v])
            if (so_far + length < std::min(distance[other], border))
                queue.emplace(distance[other] = so_far + length, other);
    }
    std::vector<bool> wide(held.size());
    for (size_t v = 0; v < held.size(); ++v) wide[v] = distance[v] < border;
    return wide;
}

}  // namespace

std::vector<std::vector<int>> body_parts(const skin::Body& body) {
    std::vector<std::vector<int>> part(1);
    std::vector<bool> in_arm(static_cast<size_t>(body.vertex_count()), false);
    const auto neighbour = neighbours_of(body);
    for (const skin::Role role : {skin::Role::left_upper_arm, skin::Role::right_upper_arm}) {
        if (body.role[role] < 0) continue;
        const std::vector<bool> held = held_by(body, body.role[role]), wide = widened(neighbour, held);
        std::vector<int> arm;
        for (int f = 0; f < body.triangle.rows(); ++f)
            if (wide[body.triangle(f, 0)] && wide[body.triangle(f, 1)] && wide[body.triangle(f, 2)]) arm.push_back(f);
        for (size_t v = 0; v < held.size(); ++v) in_arm[v] = in_arm[v] || held[v];
        if (!arm.empty()) part.push_back(std::move(arm));
    }
    for (int f = 0; f < body.triangle.rows(); ++f)
        if (!in_arm[body.triangle(f, 0)] || !in_arm[body.triangle(f, 1)] || !in_arm[body.triangle(f, 2)])
            part.front().push_back(f);
    if (part.front().empty()) part.erase(part.begin());
    return part;
}

}  // namespace toile::simulate

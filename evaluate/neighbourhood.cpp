#include "evaluate/neighbourhood.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <queue>
#include <unordered_map>
#include <utility>

#include "cloth/error.h"
#include "evaluate/strain_blocks.h"

namespace toile::evaluate {
namespace {

constexpr int64_t most_points = 20'000'000;
constexpr double tie = 1e-9;  // relative: distances that differ by rounding are the same

/// Points that share an edge with each point, in rising order.
std::vector<std::vector<int>> adjacent_points(const StrainRest& rest) {
    std::vector<std::vector<int>> adjacent(static_cast<size_t>(rest.point.rows()));
    for (Eigen::Index f = 0; f < rest.triangle.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int a = rest.triangle(f, corner), b = rest.triangle(f, (corner + 1) % 3);
            if (a == b) continue;
            adjacent[a].push_back(b);
            adjacent[b].push_back(a);
        }
    }
    for (std::vector<int>& list : adjacent) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return adjacent;
}

struct Walker {
    const StrainRest& rest;
    const NeighbourhoodRule& rule;
    std::vector<std::vector<int>> adjacent;

    double distance(int a, int b) const { return (rest.point.row(a) - rest.point.row(b)).norm(); }

    /// All points within `rule.count` rings, or joined to the centre by edges within `rule.radius`.
    std::vector<int> spread(int centre) const {
        const bool rings = rule.kind == NeighbourhoodRule::Kind::ring;
        std::vector<int> found = {centre};
        std::unordered_map<int, int> ring = {{centre, 0}};
        for (size_t next = 0; next < found.size(); ++next) {
            const int from = found[next], reached = ring.at(from) + 1;
            if (rings && reached > rule.count) break;
            for (const int to : adjacent[from])
                if ((rings || distance(centre, to) <= rule.radius * (1 + tie)) && ring.try_emplace(to, reached).second)
                    found.push_back(to);
        }
        return found;
    }

    /// The nearest first, out of those that an edge joins to one that is nearer.
    std::vector<int> nearest(int centre) const {
        using Entry = std::pair<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
        std::unordered_map<int, bool> seen = {{centre, true}};
        std::vector<int> found;
        double last = 0;
        for (front.emplace(0.0, centre); !front.empty();) {
            const auto [far, point] = front.top();
            front.pop();
            if (static_cast<int>(found.size()) > rule.count && far > last * (1 + tie)) break;
            last = std::max(last, static_cast<int>(found.size()) <= rule.count ? far : last);
            found.push_back(point);
            for (const int to : adjacent[point])
                if (seen.try_emplace(to, true).second) front.emplace(distance(centre, to), to);
        }
        return found;
    }

    std::vector<int> around(int centre) const {
        std::vector<int> found = rule.kind == NeighbourhoodRule::Kind::nearest ? nearest(centre) : spread(centre);
        std::sort(found.begin() + 1, found.end());
        return found;
    }
};

[[noreturn]] void refuse(const std::string& text) {
    throw Error("--neighbourhood is " + text + ", but should be ring:K, radius:METRES or nearest:N", "command line",
                "for example ring:2, radius:0.03 or nearest:12");
}

}  // namespace

std::string NeighbourhoodRule::text() const {
    if (kind == Kind::ring) return "ring:" + std::to_string(count);
    if (kind == Kind::nearest) return "nearest:" + std::to_string(count);
    char digits[32];
    return "radius:" + std::string(digits, std::to_chars(digits, digits + sizeof digits, radius).ptr);
}

NeighbourhoodRule neighbourhood_rule(const std::string& text) {
    const size_t colon = text.find(':');
    if (colon == std::string::npos) refuse(text);
    const std::string kind = text.substr(0, colon), value = text.substr(colon + 1);
    const char* const end = value.data() + value.size();
    NeighbourhoodRule rule;
    if (kind == "radius") {
        rule.kind = NeighbourhoodRule::Kind::radius;
        const auto [stop, error] = std::from_chars(value.data(), end, rule.radius);
        if (error != std::errc() || stop != end || !std::isfinite(rule.radius) || rule.radius <= 0) refuse(text);
        return rule;
    }
    if (kind != "ring" && kind != "nearest") refuse(text);
    rule.kind = kind == "ring" ? NeighbourhoodRule::Kind::ring : NeighbourhoodRule::Kind::nearest;
    const auto [stop, error] = std::from_chars(value.data(), end, rule.count);
    if (error != std::errc() || stop != end || rule.count < 1 || rule.count > 1'000'000) refuse(text);
    return rule;
}

Neighbourhoods find_neighbourhoods(const StrainRest& rest, const NeighbourhoodRule& rule, int jobs) {
    const Walker walker{rest, rule, adjacent_points(rest)};
    std::vector<std::vector<int>> points_of(static_cast<size_t>(rest.vertex_count));
    for (size_t p = 0; p < rest.vertex.size(); ++p)
        if (rest.vertex[p] >= 0) points_of[rest.vertex[p]].push_back(static_cast<int>(p));
    std::vector<std::vector<int>> found(points_of.size());
    std::atomic<int64_t> total = 0;
    for_blocks(rest.vertex_count, jobs, [&](int v) {
        for (const int centre : points_of[v]) {
            std::vector<int> candidate = walker.around(centre);
            if (candidate.size() > found[v].size()) found[v] = std::move(candidate);
        }
        if (total.fetch_add(static_cast<int64_t>(found[v].size())) > most_points)
            throw Error("the neighbourhoods " + rule.text() + " have more than " + std::to_string(most_points) +
                            " vertices in all",
                        "command line", "choose smaller ones");
    });
    Neighbourhoods out;
    out.offset.push_back(0);
    for (const std::vector<int>& one : found) {
        out.centre.push_back(one.empty() ? -1 : one.front());
        out.point.insert(out.point.end(), one.begin(), one.end());
        out.offset.push_back(static_cast<int>(out.point.size()));
    }
    return out;
}

}  // namespace toile::evaluate

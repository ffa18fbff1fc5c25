#include "simulate/sheet_touch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulate/certificate.h"

namespace toile::simulate {
namespace {

/// Speed at which layers that are too near are taken apart [m/s].
constexpr double recovery_speed = 0.1;
/// What is searched for lies this near [m]; on fine meshes nearer, or there would be too many pairs: this share of an
/// edge.
constexpr double widest_search = 0.004, search_share = 0.25;
/// Of that, what one substep may bring together, and what is kept at hand.
constexpr double reach_share = 0.15, sieve_share = 0.3;

/// Two features so little further apart than their thickness, over the thickness, are held from coming nearer: what
/// pulls at them shows in the passes only.
constexpr double hold = 0.1;

double largest_move(const Positions& from, const Positions& to) {
    return std::sqrt((to - from).rowwise().squaredNorm().maxCoeff());
}

}  // namespace

SheetTouches::SheetTouches(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options,
                           Eigen::VectorXd inverse_mass)
    : options_(options), inverse_mass_(std::move(inverse_mass)), candidates_(mesh.triangle, topology.edge) {
    const Eigen::VectorXd rest_length = edge_rest_lengths(mesh, topology);
    thickness_ = feature_thickness(mesh, topology, rest_length, options.thickness);
    candidates_.set_reach(thickness_.vertex, thickness_.triangle, thickness_.edge);
    wide_ = std::min(widest_search, search_share * rest_length.mean());
}

Proximity SheetTouches::proximity(const Pair& pair, const Positions& x) const {
    const FourPoints points = gather(x, pair.point);
    return pair.edges ? edge_edge_proximity(points) : vertex_triangle_proximity(points);
}

void SheetTouches::search(const Positions& x) {
    candidates_.find(x, wide_, found_);
    pairs_.clear();
    for (const VertexTrianglePair& pair : found_.vertex_triangle)
        pairs_.push_back(
            {pair.point, false, std::min(thickness_.vertex[pair.vertex], thickness_.triangle[pair.triangle])});
    for (const EdgeEdgePair& pair : found_.edge_edge)
        pairs_.push_back({pair.point, true, std::min(thickness_.edge[pair.first], thickness_.edge[pair.second])});
    searched_at_ = x;
}

void SheetTouches::sieve(const Positions& x) {
    near_.clear();
    for (const Pair& pair : pairs_)
        if (proximity(pair, x).distance() < pair.thickness + sieve_share * wide_) near_.push_back(pair);
    sieved_at_ = x;
}

const std::vector<SheetPush>& SheetTouches::pushes(const Positions& before, const Positions& now,
                                                   const Positions& supported, double time_step) {
    pushes_.clear();
    supported_ = supported;
    if (!before.allFinite() || !now.allFinite()) return pushes_;
    // Two features come nearer by at most what both move.
    const bool first = searched_at_.rows() != before.rows();
    if (first || 2.0 * largest_move(searched_at_, before) > (1.0 - sieve_share) * wide_) {
        search(before);
        sieve(before);
    } else if (2.0 * largest_move(sieved_at_, before) > (sieve_share - reach_share) * wide_) {
        sieve(before);
    }
    for (const Pair& pair : near_) add_push(pair, before, now, time_step);
    return pushes_;
}

void SheetTouches::add_push(const Pair& pair, const Positions& before, const Positions& now, double time_step) {
    const Proximity start = proximity(pair, before);
    const double distance = start.distance();
    if (distance > pair.thickness + reach_share * wide_) return;
    if (!(distance > 0.0)) return;
    const Eigen::Vector3d normal = start.difference / distance;
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();  // the first feature's nearest point against the second's
    for (int i = 0; i < 4; ++i)
        moved += start.weight[i] * (now.row(pair.point[i]) - before.row(pair.point[i])).transpose();
    const double above = distance - pair.thickness;
    const double gap = above < 0.0                     ? std::min(pair.thickness, distance + recovery_speed * time_step)
                       : above < hold * pair.thickness ? distance
                                                       : pair.thickness;
    const double lacking = std::max(0.0, gap - distance - normal.dot(moved));
    if (above >= hold * pair.thickness && !(lacking > 0.0)) return;
    const double slip = (moved - normal * normal.dot(moved)).norm(), most = options_.friction * lacking;

    SheetPush push{};
    push.normal = normal;
    push.gap = gap;
    push.grip = slip > most ? most / slip : options_.friction > 0.0 ? 1.0 : 0.0;
    push.recovering = distance < pair.thickness;
    // Of an edge the nearer end; of either edge, as what is supported can give way on neither side of the form.
    const std::array<double, 4>& w = start.weight;
    const int one = pair.edges && std::abs(w[1]) > std::abs(w[0]) ? 1 : 0;
    const int other = pair.edges ? (std::abs(w[3]) > std::abs(w[2]) ? 3 : 2) : one;
    for (const bool supported : {true, false})
        for (const int first : {one, other})
            if (add_shared(solved_for(first, pair, start, push), supported)) return;
}

/// The push with the pair's distance divided by the weight of one of its four points.
SheetPush SheetTouches::solved_for(int one, const Pair& pair, const Proximity& start, SheetPush push) const {
    const double scale = start.weight[one];
    push.vertex = pair.point[one];
    for (int i = 0, k = 0; i < 4; ++i) {
        if (i == one) continue;
        push.other[k] = pair.point[i];
        push.weight[k++] = -start.weight[i] / scale;
    }
    if (scale < 0.0) push.normal = -push.normal;
    push.gap /= std::abs(scale);
    return push;
}

/// Inverse mass on a way, 0 against a solid.
double SheetTouches::mobility(int vertex, const Eigen::Vector3d& way) const {
    return supported_.row(vertex).dot(way) < 0.0 ? 0.0 : inverse_mass_[vertex];
}

/// Adds the push. The others move as their weighted mean, with one inverse mass; not at all where one of them is held.
/// False where nothing can move.
bool SheetTouches::add_shared(SheetPush push, bool supported) {
    double other = 0.0, squares = 0.0;
    bool held = false;
    for (int k = 0; k < 3; ++k) {
        if (push.weight[k] == 0.0) continue;
        const Eigen::Vector3d way = -push.weight[k] * push.normal;
        const double w = supported ? mobility(push.other[k], way) : inverse_mass_[push.other[k]];
        other += push.weight[k] * push.weight[k] * w;
        squares += push.weight[k] * push.weight[k];
        held |= !(w > 0.0);
    }
    const double one = supported ? mobility(push.vertex, push.normal) : inverse_mass_[push.vertex];
    const double mean = held ? 0.0 : other / squares, sum = one + mean * squares;
    if (!(sum > 0.0)) return false;
    push.vertex_share = one / sum;
    push.other_share = mean / sum;
    pushes_.push_back(push);
    return true;
}

}  // namespace toile::simulate

#include "simulate/collision_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "cloth/topology.h"
#include "simulate/body_parts.h"
#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// A joint that has turned further than this since the level set was made may bring another part of the body close
/// [rad].
constexpr double largest_carried_rotation = 0.6;
/// On the way to a pose the level set may be off by this many times the error bound.
constexpr double path_error = 3.0;
/// How far from the cloth the body is kept [m]: further than cloth slides on it before the level set is made anew.
constexpr double reach = 0.07;
/// Voxel on the way to a pose over the voxel at the pose itself: only where the cloth comes to rest has to be exact.
constexpr double path_coarseness = 2.0;
/// Width of the band beyond the thickness, in voxels: room for what an iteration moves and for the interpolation's
/// stencil.
constexpr double band_voxels = 3.0;

/// Which body vertices have a cloth vertex within about `reach`: a grid of that spacing, looked up with its neighbours.
std::vector<bool> vertices_near(const Positions& body, const Positions& cloth, double reach) {
    using Key = std::array<int, 3>;
    auto key_of = [&](const auto& row, const Key& shift) {
        Key key;
        for (int axis = 0; axis < 3; ++axis) key[axis] = static_cast<int>(std::floor(row[axis] / reach)) + shift[axis];
        return key;
    };
    std::set<Key> occupied;
    for (int v = 0; v < cloth.rows(); ++v)
        for (int shift = 0; shift < (cloth.row(v).allFinite() ? 27 : 0); ++shift)
            occupied.insert(key_of(cloth.row(v), {shift / 9 - 1, shift / 3 % 3 - 1, shift % 3 - 1}));
    std::vector<bool> near(static_cast<size_t>(body.rows()));
    for (int v = 0; v < body.rows(); ++v) near[v] = occupied.contains(key_of(body.row(v), {0, 0, 0}));
    return near;
}

}  // namespace

Positions ReachableSurface::positions(const Positions& posed_body) const {
    Positions all(body_vertex_count + static_cast<int>(cap.size()), 3);
    all.topRows(body_vertex_count) = posed_body;
    for (size_t k = 0; k < cap.size(); ++k) {
        Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
        for (int v : cap[k]) centre += posed_body.row(v);
        all.row(body_vertex_count + static_cast<int>(k)) = centre / static_cast<double>(cap[k].size());
    }
    return all;
}

ReachableSurface reachable_surface(const Triangles& body_triangle, const Positions& posed_body, const Positions& cloth,
                                   double within) {
    std::vector<int> all(static_cast<size_t>(body_triangle.rows()));
    std::iota(all.begin(), all.end(), 0);
    return reachable_surface(body_triangle, std::vector<std::vector<int>>{all}, posed_body, cloth, within);
}

ReachableSurface reachable_surface(const Triangles& body_triangle, const std::vector<std::vector<int>>& part,
                                   const Positions& posed_body, const Positions& cloth, double within) {
    const std::vector<bool> near = vertices_near(posed_body, cloth, within);
    ReachableSurface surface;
    surface.body_vertex_count = static_cast<int>(posed_body.rows());
    std::vector<Eigen::RowVector3i> row;
    int kept_of_body = 0;
    const auto add_part = [&](const std::vector<int>& kept) {
        for (const int f : kept) row.emplace_back(body_triangle.row(f));
        const Triangles cut = body_triangle(kept, Eigen::all);
        for (std::vector<int>& loop : boundary_loops(cut)) {
            const int centre = surface.body_vertex_count + static_cast<int>(surface.cap.size());
            for (size_t i = 0; i < loop.size(); ++i) row.emplace_back(loop[(i + 1) % loop.size()], loop[i], centre);
            surface.cap.push_back(std::move(loop));
        }
        surface.part_end.push_back(static_cast<int>(row.size()));
        kept_of_body += static_cast<int>(kept.size());
    };
    for (const std::vector<int>& whole : part) {
        std::vector<int> kept;
        for (const int f : whole)
            if (near[body_triangle(f, 0)] || near[body_triangle(f, 1)] || near[body_triangle(f, 2)]) kept.push_back(f);
        if (!kept.empty()) add_part(kept);
    }
    if (row.empty())  // cloth that is nowhere near: the whole body
        for (const std::vector<int>& whole : part)
            if (!whole.empty()) add_part(whole);
    surface.share =
        static_cast<double>(kept_of_body) / static_cast<double>(std::max<Eigen::Index>(body_triangle.rows(), 1));
    surface.triangle.resize(static_cast<int>(row.size()), 3);
    for (size_t k = 0; k < row.size(); ++k) surface.triangle.row(static_cast<int>(k)) = row[k];
    return surface;
}

BodyLevelSet::BodyLevelSet(const skin::Body& body, const Positions& posed_body, const Positions& cloth, double voxel,
                           double thickness)
    : BodyLevelSet(body, std::make_shared<const std::vector<std::vector<int>>>(body_parts(body)), posed_body, cloth,
                   voxel, thickness) {}

BodyLevelSet::BodyLevelSet(const skin::Body& body, std::shared_ptr<const std::vector<std::vector<int>>> parts,
                           const Positions& posed_body, const Positions& cloth, double voxel, double thickness)
    : part(std::move(parts)),
      surface(reachable_surface(body.triangle, *part, posed_body, cloth, reach)),
      level_set(surface.triangle, surface.part_end, surface.positions(posed_body), voxel,
                thickness + band_voxels * voxel) {}

CollisionBody::CollisionBody(const skin::Body& body, skin::SkinningMethod method, const LevelSetOptions& options,
                             double thickness)
    : body_(body),
      method_(method),
      options_(options),
      thickness_(thickness),
      neighbour_(static_cast<size_t>(body.vertex_count())),
      in_use_(static_cast<size_t>(body.vertex_count()), 0) {
    for (int f = 0; f < body.triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            neighbour_[body.triangle(f, corner)].push_back(body.triangle(f, (corner + 1) % 3));
}

CollisionBody::State CollisionBody::state_at(const skin::Pose& pose) const {
    State state{skin::skin_positions(body_, pose, method_), {}, skin::blended_rotations(body_, pose), pose};
    const Positions normal = vertex_normals(body_.triangle, state.position);
    state.frame.assign(static_cast<size_t>(body_.vertex_count()), Eigen::Matrix3d::Identity());
    for (int v = 0; v < body_.vertex_count(); ++v) {
        if (neighbour_[v].empty()) continue;
        const Eigen::Vector3d n = normal.row(v).transpose();
        const Eigen::Vector3d side = (state.position.row(neighbour_[v].front()) - state.position.row(v)).transpose();
        const Eigen::Vector3d bitangent = n.cross(side);
        if (!(bitangent.norm() > 1e-3 * side.norm())) continue;  // a spike has no tangent plane
        state.frame[v].col(1) = bitangent.normalized();
        state.frame[v].col(0) = state.frame[v].col(1).cross(n);
        state.frame[v].col(2) = n;
    }
    return state;
}

double CollisionBody::carried_error() const {
    double worst = 0.0;
    for (size_t v = 0; v < in_use_.size(); ++v) {
        if (!in_use_[v]) continue;
        const Eigen::Vector3d normal = now_.frame[v].col(2);
        for (int w : neighbour_[v]) {
            const Eigen::Vector3d before =
                (built_.position.row(w) - built_.position.row(static_cast<int>(v))).transpose();
            const Eigen::Vector3d after = (now_.position.row(w) - now_.position.row(static_cast<int>(v))).transpose();
            worst = std::max(worst, std::abs(normal.dot(after - since_built_[v] * before)));
        }
    }
    // A point lies within half an edge of the vertex it is tied to, where the deviation, being quadratic, is a quarter.
    return 0.25 * worst;
}

void CollisionBody::use(std::shared_ptr<const BodyLevelSet> built) {
    sampler_.reset();
    level_set_ = std::move(built);
    sampler_.emplace(level_set_->level_set);
    built_ = now_;
    since_built_.assign(now_.frame.size(), Eigen::Matrix3d::Identity());
}

void CollisionBody::start(const skin::Pose& pose, std::shared_ptr<const BodyLevelSet> built) {
    now_ = state_at(pose);
    before_ = now_;
    use(std::move(built));
    std::fill(in_use_.begin(), in_use_.end(), 0);
}

void CollisionBody::move_to(const skin::Pose& pose, DrapeReport& report) {
    const Stopwatch watch(report.level_set_seconds);
    before_ = std::move(now_);
    now_ = state_at(pose);
    for (size_t v = 0; v < since_built_.size(); ++v) since_built_[v] = now_.frame[v] * built_.frame[v].transpose();
}

void CollisionBody::fit_level_set(bool exact, const Positions& cloth, DrapeReport& report) {
    const Stopwatch watch(report.level_set_seconds);
    if (exact || skin::largest_joint_rotation(built_.pose, now_.pose) > largest_carried_rotation ||
        carried_error() > path_error * options_.error_bound) {
        ++report.level_sets;
        const double voxel = options_.voxel * (exact ? 1.0 : path_coarseness);
        use(std::make_shared<const BodyLevelSet>(body_, level_set_->part, now_.position, cloth, voxel, thickness_));
    }
    std::fill(in_use_.begin(), in_use_.end(), 0);
}

Eigen::Vector3d CollisionBody::carry(const Eigen::Vector3d& point, int piece) const {
    const Eigen::Quaterniond turn = now_.rotation[piece] * before_.rotation[piece].conjugate();
    return turn * (point - before_.position.row(piece).transpose()) + now_.position.row(piece).transpose();
}

Eigen::Vector3d CollisionBody::to_built(const Eigen::Vector3d& world, int piece) const {
    return since_built_[piece].transpose() * (world - now_.position.row(piece).transpose()) +
           built_.position.row(piece).transpose();
}

Obstacle::Contact CollisionBody::sample(const Eigen::Vector3d& point, int piece) const {
    const skin::LevelSet::Sampler::Smooth smooth = sampler_->smooth(to_built(point, piece));
    return {smooth.distance, since_built_[piece] * smooth.gradient};
}

double CollisionBody::distance(const Eigen::Vector3d& point, int piece) const {
    return sampler_->smooth_distance(to_built(point, piece));
}

Eigen::Matrix3d CollisionBody::curvature(const Eigen::Vector3d& point, int piece) const {
    return since_built_[piece] * sampler_->smooth_curvature(to_built(point, piece)) * since_built_[piece].transpose();
}

int CollisionBody::piece_near(const Eigen::Vector3d& point, int last) const {
    const skin::LevelSet::Sample sample = (*sampler_)(to_built(point, last));
    if (sample.triangle < 0) return last;
    const Eigen::RowVector3d p = to_built(point, last).transpose();
    int nearest = last;
    double nearest_squared = std::numeric_limits<double>::infinity();
    for (int corner = 0; corner < 3; ++corner) {
        const int v = level_set_->surface.triangle(sample.triangle, corner);
        if (v >= body_.vertex_count()) continue;
        const double squared = (built_.position.row(v) - p).squaredNorm();
        if (squared < nearest_squared) {
            nearest_squared = squared;
            nearest = v;
        }
    }
    in_use_[nearest] = 1;
    return nearest;
}

Eigen::Vector3d CollisionBody::to_world(const Eigen::Vector3d& local, int piece) const {
    return now_.frame[piece] * local + now_.position.row(piece).transpose();
}

Eigen::Vector3d CollisionBody::to_local(const Eigen::Vector3d& world, int piece) const {
    return now_.frame[piece].transpose() * (world - now_.position.row(piece).transpose());
}

}  // namespace toile::simulate

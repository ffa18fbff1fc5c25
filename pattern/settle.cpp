#include "pattern/settle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "cloth/topology.h"
#include "skin/level_set.h"
#include "skin/surface_query.h"

namespace toile::pattern {
namespace {

constexpr double voxel = 0.008;
constexpr double band = 0.032;

/// The body with its open boundaries closed by fans around their middles: an open surface has no inside.
skin::Surface closed(const skin::Body& body) {
    const std::vector<std::vector<int>> loops = boundary_loops(body.triangle);
    size_t fans = 0;
    for (const std::vector<int>& loop : loops) fans += loop.size();
    skin::Surface surface = {body.triangle, body.rest_position};
    int row = static_cast<int>(body.triangle.rows()), center = body.vertex_count();
    surface.triangle.conservativeResize(row + static_cast<int>(fans), 3);
    surface.position.conservativeResize(center + static_cast<int>(loops.size()), 3);
    for (const std::vector<int>& loop : loops) {
        surface.position.row(center).setZero();
        for (size_t i = 0; i < loop.size(); ++i) {
            surface.position.row(center) += body.rest_position.row(loop[i]) / static_cast<double>(loop.size());
            surface.triangle.row(row++) << loop[(i + 1) % loop.size()], loop[i], center;
        }
        ++center;
    }
    return surface;
}

class Settler {
  public:
    Settler(ClothMesh& mesh, const skin::Surface& body, const SettleOptions& options)
        : mesh_(mesh),
          options_(options),
          query_(body.triangle, body.position),
          level_set_(body.triangle, body.position, voxel, band),
          sample_(level_set_),
          topology_(build_topology(mesh.triangle)),
          rest_length_(pattern_edge_lengths(mesh)) {}

    SettleReport run() {
        leave_depths();
        for (int sweep = 0; sweep < options_.sweeps; ++sweep) {
            smooth();
            pull_edges();
            leave_body(sweep % 4 == 3);
        }
        for (int sweep = 0; sweep < 40; ++sweep) leave_body(true);
        return report();
    }

  private:
    Eigen::Vector3d at(int v) const { return mesh_.rest_position.row(v); }

    /// Vertices too deep for the level set's band go to the nearest surface.
    void leave_depths() {
        for (int v = 0; v < mesh_.vertex_count(); ++v) {
            if (sample_.distance(at(v)) > -0.9 * band) continue;
            const auto nearest = query_.nearest(at(v));
            mesh_.rest_position.row(v) = nearest.position.transpose();
        }
    }

    /// Towards the mean of the neighbours: irons out folds; at a border only along it, so that it does not creep in.
    void smooth() {
        Positions sum = Positions::Zero(mesh_.vertex_count(), 3);
        Eigen::VectorXd count = Eigen::VectorXd::Zero(mesh_.vertex_count());
        std::vector<bool> border(static_cast<size_t>(mesh_.vertex_count()), false);
        for (int e = 0; e < topology_.edge.rows(); ++e)
            if (topology_.edge_triangle(e, 1) < 0) border[topology_.edge(e, 0)] = border[topology_.edge(e, 1)] = true;
        for (int e = 0; e < topology_.edge.rows(); ++e) {
            for (int k = 0; k < 2; ++k) {
                const int v = topology_.edge(e, k), other = topology_.edge(e, 1 - k);
                if (border[v] && topology_.edge_triangle(e, 1) >= 0) continue;
                sum.row(v) += mesh_.rest_position.row(other);
                count[v] += 1.0;
            }
        }
        for (int v = 0; v < mesh_.vertex_count(); ++v)
            if (count[v] > 0.0)
                mesh_.rest_position.row(v) += options_.bending * (sum.row(v) / count[v] - mesh_.rest_position.row(v));
    }

    void pull_edges() {
        for (int e = 0; e < topology_.edge.rows(); ++e) {
            auto a = mesh_.rest_position.row(topology_.edge(e, 0)), b = mesh_.rest_position.row(topology_.edge(e, 1));
            const Eigen::RowVector3d along = b - a;
            const double length = along.norm();
            if (length < 1e-9) continue;
            // Cloth gives way to compression, and would buckle if it were pressed apart at full strength.
            const double share = length > rest_length_[e] ? 0.5 : 0.2;
            const Eigen::RowVector3d move = share * (1.0 - rest_length_[e] / length) * along;
            a += move;
            b -= move;
        }
    }

    void push(std::initializer_list<int> vertices, double clearance) {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (int v : vertices) middle += at(v) / static_cast<double>(vertices.size());
        const auto sample = sample_(middle);
        if (sample.distance >= clearance) return;
        const double steepness = sample.gradient.norm();
        if (steepness < 1e-6) return;
        const Eigen::RowVector3d move = (clearance - sample.distance) / steepness * sample.gradient.transpose();
        for (int v : vertices) mesh_.rest_position.row(v) += move;
    }

    void leave_body(bool between_vertices) {
        for (int v = 0; v < mesh_.vertex_count(); ++v) push({v}, options_.clearance);
        if (!between_vertices) return;
        for (int e = 0; e < topology_.edge.rows(); ++e)
            push({topology_.edge(e, 0), topology_.edge(e, 1)}, options_.clearance);
        for (int f = 0; f < mesh_.triangle_count(); ++f)
            push({mesh_.triangle(f, 0), mesh_.triangle(f, 1), mesh_.triangle(f, 2)}, options_.clearance);
    }

    SettleReport report() const {
        SettleReport report;
        report.nearest = std::numeric_limits<double>::infinity();
        auto look = [&](const Eigen::Vector3d& p) {
            // The level set rules out most of the points.
            if (sample_.distance(p) > options_.clearance + voxel) return;
            report.nearest = std::min(report.nearest, query_.nearest(p).signed_distance);
        };
        for (int v = 0; v < mesh_.vertex_count(); ++v) look(at(v));
        for (int f = 0; f < mesh_.triangle_count(); ++f)
            look((at(mesh_.triangle(f, 0)) + at(mesh_.triangle(f, 1)) + at(mesh_.triangle(f, 2))) / 3.0);
        report.min_stretch = std::numeric_limits<double>::infinity();
        for (int e = 0; e < topology_.edge.rows(); ++e) {
            look(0.5 * (at(topology_.edge(e, 0)) + at(topology_.edge(e, 1))));
            const double stretch = (at(topology_.edge(e, 0)) - at(topology_.edge(e, 1))).norm() / rest_length_[e];
            report.max_stretch = std::max(report.max_stretch, stretch);
            report.min_stretch = std::min(report.min_stretch, stretch);
        }
        return report;
    }

    ClothMesh& mesh_;
    const SettleOptions& options_;
    skin::SurfaceQuery query_;
    skin::LevelSet level_set_;
    skin::LevelSet::Sampler sample_;
    Topology topology_;
    Eigen::VectorXd rest_length_;
};

}  // namespace

SettleReport settle(ClothMesh& mesh, const skin::Body& body, const SettleOptions& options) {
    return Settler(mesh, closed(body), options).run();
}

Eigen::VectorXd pattern_edge_lengths(const ClothMesh& mesh) {
    const Topology topology = build_topology(mesh.triangle);
    Eigen::VectorXd length = Eigen::VectorXd::Zero(topology.edge.rows());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(topology.edge.rows());
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int e = topology.triangle_edge(f, k);
            length[e] += (mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 1) % 3)) -
                          mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 2) % 3)))
                             .norm();
            count[e] += 1.0;
        }
    }
    return length.cwiseQuotient(count);
}

}  // namespace toile::pattern

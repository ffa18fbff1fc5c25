#include "pattern/push_out.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::pattern {
namespace {

constexpr int rounds = 25;
constexpr int spreading = 4;  // rings of neighbours that follow

/// Signed distance that does not trust the nearest feature alone: near folds of a body that overlaps itself its
/// normal may point the wrong way.
double signed_distance(const skin::SurfaceQuery& body, const Eigen::Vector3d& point,
                       const skin::SurfaceQuery::Nearest& nearest) {
    if (nearest.signed_distance > -0.01) return nearest.signed_distance;
    return body.winding_number(point) > 0.5 ? nearest.signed_distance : nearest.distance;
}

/// How each vertex has to move [m]: zero where it is far enough from the body.
class Moves {
  public:
    Moves(const skin::SurfaceQuery& body, double clearance, long vertices)
        : distance(static_cast<size_t>(vertices), 0.0),
          move(Positions::Zero(vertices, 3)),
          body_(body),
          clearance_(clearance) {}

    /// Looks again at vertices that may have come near.
    void update(const Positions& position, double largest_move) {
        for (int v = 0; v < position.rows(); ++v) {
            move.row(v).setZero();
            distance[v] -= largest_move;
            if (distance[v] > clearance_) continue;
            const Eigen::Vector3d point = position.row(v);
            const auto nearest = body_.nearest(point);
            distance[v] = signed_distance(body_, point, nearest);
            if (distance[v] >= clearance_) continue;
            Eigen::Vector3d out = point - nearest.position;
            if (distance[v] < 0.0) out = -out;
            if (out.norm() < 1e-9) continue;  // on the surface: its neighbours take it along
            move.row(v) = (clearance_ - distance[v]) * out.normalized().transpose();
        }
    }

    std::vector<double> distance;  // a lower bound, exact where a vertex is near
    Positions move;

  private:
    const skin::SurfaceQuery& body_;
    double clearance_;
};

/// Vertices without a move of their own follow their neighbours, less with each ring.
void spread(Positions& move, const Edges& edge) {
    std::vector<bool> own(static_cast<size_t>(move.rows()));
    for (int v = 0; v < move.rows(); ++v) own[v] = !move.row(v).isZero(0.0);
    for (int ring = 0; ring < spreading; ++ring) {
        Positions sum = Positions::Zero(move.rows(), 3);
        Eigen::VectorXd count = Eigen::VectorXd::Zero(move.rows());
        for (int e = 0; e < edge.rows(); ++e) {
            for (int k = 0; k < 2; ++k) {
                sum.row(edge(e, k)) += move.row(edge(e, 1 - k));
                count[edge(e, k)] += 1.0;
            }
        }
        for (int v = 0; v < move.rows(); ++v)
            if (!own[v] && count[v] > 0.0) move.row(v) = sum.row(v) / count[v];
    }
}

void refuse_deep(const std::vector<double>& distance, const PushOutOptions& options, const std::string& where) {
    const auto deepest = std::min_element(distance.begin(), distance.end());
    if (-*deepest <= options.max_push) return;
    std::ostringstream text;
    text.precision(3);
    text << "the garment does not fit the body: vertex " << deepest - distance.begin() << " lies " << -1000.0 * *deepest
         << " mm inside it, at most " << 1000.0 * options.max_push << " mm can be pushed out";
    throw Error(text.str(), where, "check the garment's unit and up axis, and that it was made for this body");
}

}  // namespace

PushOutReport push_out(const Triangles& triangle, Positions& position, const skin::SurfaceQuery& body,
                       const PushOutOptions& options, const std::string& where) {
    const Edges edge = build_topology(triangle).edge;
    const Positions start = position;
    // A little further than asked, so that the last vertices need not be chased.
    Moves moves(body, 1.1 * options.clearance, position.rows());
    moves.update(position, 0.0);
    refuse_deep(moves.distance, options, where);
    PushOutReport report;
    for (double distance : moves.distance) {
        report.inside += distance < 0.0;
        report.deepest = std::max(report.deepest, -distance);
    }
    for (int round = 0; round < rounds; ++round) {
        const double largest = moves.move.rowwise().norm().maxCoeff();
        if (!(largest > 0.05 * options.clearance)) break;
        spread(moves.move, edge);
        position += moves.move;
        moves.update(position, moves.move.rowwise().norm().maxCoeff());
    }
    for (int v = 0; v < position.rows(); ++v) {
        report.moved += (position.row(v) - start.row(v)).norm() > 1e-4;
        report.still_near += moves.distance[v] < 0.5 * options.clearance;
    }
    return report;
}

}  // namespace toile::pattern

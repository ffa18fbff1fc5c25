#include "pattern/winding.h"

#include <Eigen/Geometry>
#include <cmath>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::pattern {
namespace {

std::string edge_name(const Topology& topology, int e) {
    return "edge (" + std::to_string(topology.edge(e, 0)) + ", " + std::to_string(topology.edge(e, 1)) + ")";
}

/// Whether triangle f runs along its edge e from the smaller to the larger vertex.
bool forward(const Triangles& triangle, const Topology& topology, int f, int e) {
    for (int k = 0; k < 3; ++k)
        if (topology.triangle_edge(f, k) == e) return triangle(f, (k + 1) % 3) == topology.edge(e, 0);
    return false;
}

/// How far a piece, with its turns, faces outwards: area times the cosine to the way out, summed.
double outwardness(const std::vector<int>& piece, const std::vector<bool>& turn, const Triangles& triangle,
                   const Positions& position, const skin::SurfaceQuery* body) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (int f : piece)
        for (int k = 0; k < 3; ++k) middle += position.row(triangle(f, k)) / (3.0 * static_cast<double>(piece.size()));
    double sum = 0.0, area = 0.0;
    for (int f : piece) {
        const Eigen::RowVector3d a = position.row(triangle(f, 0)), b = position.row(triangle(f, 1)),
                                 c = position.row(triangle(f, 2)), center = (a + b + c) / 3.0;
        const Eigen::RowVector3d normal = (turn[f] ? -0.5 : 0.5) * (b - a).cross(c - a);
        Eigen::RowVector3d way_out = center - middle;
        if (body) {
            const auto nearest = body->nearest(center.transpose());
            way_out = center - nearest.position.transpose();
            if (nearest.signed_distance < 0.0) way_out *= -1.0;
        }
        area += normal.norm();
        if (way_out.norm() > 0.0) sum += normal.dot(way_out.normalized());
    }
    return area > 0.0 ? sum / area : 0.0;
}

}  // namespace

std::vector<bool> triangles_to_turn(const Triangles& triangle, const Positions& position,
                                    const skin::SurfaceQuery* body, const std::string& where) {
    const Topology topology = build_topology(triangle);
    if (topology.non_manifold_edge >= 0)
        throw Error(edge_name(topology, topology.non_manifold_edge) + " belongs to more than two triangles", where,
                    "a garment is one layer of cloth; merge or delete the extra triangles");
    const size_t count = static_cast<size_t>(triangle.rows());
    std::vector<bool> turn(count, false), seen(count, false);
    for (int seed = 0; seed < triangle.rows(); ++seed) {
        if (seen[seed]) continue;
        std::vector<int> piece = {seed};
        seen[seed] = true;
        for (size_t next = 0; next < piece.size(); ++next) {
            const int f = piece[next];
            for (int k = 0; k < 3; ++k) {
                const int e = topology.triangle_edge(f, k);
                const int other =
                    topology.edge_triangle(e, 0) == f ? topology.edge_triangle(e, 1) : topology.edge_triangle(e, 0);
                if (other < 0) continue;
                const bool same = forward(triangle, topology, f, e) == forward(triangle, topology, other, e);
                if (!seen[other]) {
                    seen[other] = true;
                    turn[other] = turn[f] != same;
                    piece.push_back(other);
                } else if (turn[other] != (turn[f] != same)) {
                    throw Error("the triangles cannot be wound the same way round: at " + edge_name(topology, e) +
                                    " the surface comes back turned over",
                                where);
                }
            }
        }
        double outwards = outwardness(piece, turn, triangle, position, body);
        size_t turned = 0;
        for (int f : piece) turned += turn[f];
        if (std::abs(outwards) < 0.02) outwards = 2 * turned > piece.size() ? -1.0 : 1.0;
        if (outwards < 0.0)
            for (int f : piece) turn[f] = !turn[f];
    }
    return turn;
}

}  // namespace toile::pattern

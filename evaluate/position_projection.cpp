#include "evaluate/position_projection.h"

#include <algorithm>

#include "cloth/error.h"

namespace toile::evaluate {

PositionProjection::PositionProjection(const Edges& edge, const Eigen::VectorXd& edge_max_length,
                                       const Eigen::VectorXd& target_stiffness)
    : edge_(edge), max_length_(edge_max_length), first_share_(edge.rows()), vertex_count_(target_stiffness.size()) {
    if (edge_max_length.size() != edge.rows()) throw Error("each edge needs one largest length");
    if (edge.size() > 0 && (edge.minCoeff() < 0 || edge.maxCoeff() >= vertex_count_))
        throw Error("an edge names a vertex without stiffness");
    // w_a / (w_a + w_b) with w = 1 / k
    for (Eigen::Index e = 0; e < edge.rows(); ++e) {
        const double a = target_stiffness[edge(e, 0)], b = target_stiffness[edge(e, 1)];
        first_share_[e] = b / (a + b);
    }
}

void PositionProjection::sweep(Positions& position, int sweeps) const {
    if (position.rows() != vertex_count_) throw Error("positions of another number of vertices");
    for (int k = 0; k < sweeps; ++k)
        for (Eigen::Index e = 0; e < edge_.rows(); ++e) {
            const int a = edge_(e, 0), b = edge_(e, 1);
            const Eigen::RowVector3d along = position.row(a) - position.row(b);
            const double length = along.norm(), over = length - max_length_[e];
            if (!(over > 0.0)) continue;
            const Eigen::RowVector3d move = (over / length) * along;
            position.row(a) -= first_share_[e] * move;
            position.row(b) += (1.0 - first_share_[e]) * move;
        }
}

double PositionProjection::overstretch(const Positions& position) const {
    double largest = 0.0;
    for (Eigen::Index e = 0; e < edge_.rows(); ++e) {
        const double length = (position.row(edge_(e, 0)) - position.row(edge_(e, 1))).norm();
        largest = std::max(largest, length / max_length_[e] - 1.0);
    }
    return largest;
}

}  // namespace toile::evaluate

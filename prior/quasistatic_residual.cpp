#include <algorithm>
#include <cmath>

#include "cloth/error.h"
#include "prior/quasistatic.h"

namespace toile::prior {
namespace {

using Map = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;

/// Adds the gradient of Σ ½ k (l − l̄)²; gives the largest force of a spring that has no length.
double add_springs(const Edges& spring, const Eigen::VectorXd& stiffness, const Eigen::VectorXd& rest_length,
                   const Map& r, Positions& gradient) {
    double lost = 0.0;
    for (Eigen::Index e = 0; e < spring.rows(); ++e) {
        const int a = spring(e, 0), b = spring(e, 1);
        const Eigen::RowVector3d d = r.row(a) - r.row(b);
        const double length = d.norm();
        if (!(length > 0.0)) {
            lost = std::max(lost, stiffness[e] * rest_length[e]);
            continue;
        }
        const Eigen::RowVector3d force = stiffness[e] * (length - rest_length[e]) / length * d;
        gradient.row(a) += force;
        gradient.row(b) -= force;
    }
    return lost;
}

struct Forces {
    double largest, lost;
};

Forces forces(const QuasistaticModel& model, const Map& predicted, const Map& r) {
    Positions gradient = Positions::Zero(model.vertex_count, 3);
    for (int i = 0; i < model.vertex_count; ++i)
        gradient.row(i) += model.target_stiffness[i] * (r.row(i) - predicted.row(i));
    const double lost =
        std::max(add_springs(model.edge_spring, model.edge_stiffness, model.edge_rest_length, r, gradient),
                 add_springs(model.bending_spring, model.bending_stiffness, model.bending_rest_length, r, gradient));
    for (Eigen::Index e = 0; e < model.axial_spring.rows(); ++e) {
        const double u = model.axial_weight(e, 0), v = model.axial_weight(e, 1);
        const double weight[4] = {1.0 - u, u, v - 1.0, -v};
        // Relative to one corner: weights add up to zero.
        const Eigen::RowVector3d corner = r.row(model.axial_spring(e, 0));
        Eigen::RowVector3d gap = Eigen::RowVector3d::Zero();
        for (int i = 1; i < 4; ++i) gap += weight[i] * (r.row(model.axial_spring(e, i)) - corner);
        for (int i = 0; i < 4; ++i)
            gradient.row(model.axial_spring(e, i)) += model.axial_stiffness[e] * weight[i] * gap;
    }
    return {model.vertex_count > 0 ? gradient.cwiseAbs().maxCoeff() : 0.0, lost};
}

}  // namespace

double quasistatic_residual(const QuasistaticModel& model, std::span<const double> predicted,
                            std::span<const double> position) {
    const auto size = 3 * static_cast<size_t>(model.vertex_count);
    if (predicted.size() != size || position.size() != size)
        throw Error("the positions do not fit the quasistatic model's vertices");
    const Map r_hat(predicted.data(), model.vertex_count, 3), r(position.data(), model.vertex_count, 3);
    const Forces at = forces(model, r_hat, r);
    const Eigen::Index edges = model.edge_spring.rows();
    const double reference =
        edges > 0 ? model.edge_stiffness.dot(model.edge_rest_length) / static_cast<double>(edges) : 0.0;
    const double scale = std::max(forces(model, r_hat, r_hat).largest, reference);
    const double largest = std::max(at.largest, at.lost);
    return largest == 0.0 ? 0.0 : largest / scale;
}

}  // namespace toile::prior

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "prior/inextensibility.h"

namespace toile::prior {
namespace {

using ConstPoints = Eigen::Map<const Positions>;

/// ∂l_e/∂r_a = −∂l_e/∂r_b; of an edge without length, whose length has no gradient, the subgradient zero.
Eigen::RowVector3d edge_direction(const ConstPoints& position, int a, int b, double& length) {
    const Eigen::RowVector3d vector = position.row(a) - position.row(b);
    length = vector.stableNorm();
    return length > 0.0 ? Eigen::RowVector3d(vector / length) : Eigen::RowVector3d::Zero();
}

void check_sizes(const InextensibilityModel& model, std::span<const double> predicted, std::span<const double> position,
                 std::span<const double> multiplier) {
    const size_t coordinates = 3 * static_cast<size_t>(model.vertex_count);
    if (predicted.size() != coordinates || position.size() != coordinates)
        throw Error("the residual needs one prediction and one position for each of " +
                    std::to_string(model.vertex_count) + " vertices");
    if (multiplier.size() != static_cast<size_t>(model.edge.rows()))
        throw Error("the residual needs one multiplier for each of " + std::to_string(model.edge.rows()) + " edges");
}

}  // namespace

double inextensibility_residual(const InextensibilityModel& model, std::span<const double> predicted,
                                std::span<const double> position, std::span<const double> multiplier) {
    check_sizes(model, predicted, position, multiplier);
    const ConstPoints r(position.data(), model.vertex_count, 3), r_hat(predicted.data(), model.vertex_count, 3);
    const Eigen::Map<const Eigen::VectorXd> lambda(multiplier.data(), model.edge.rows());

    Positions force = model.target_stiffness.asDiagonal() * (r - r_hat);
    if (!force.allFinite() || !lambda.allFinite()) return std::numeric_limits<double>::infinity();
    double size = force.size() > 0 ? force.cwiseAbs().maxCoeff() : 0.0;
    if (lambda.size() > 0) size = std::max(size, lambda.maxCoeff());

    double overstretch = 0.0, complementarity = 0.0, negative = 0.0;
    for (Eigen::Index e = 0; e < model.edge.rows(); ++e) {
        const int a = model.edge(e, 0), b = model.edge(e, 1);
        double length = 0.0;
        const Eigen::RowVector3d pull = lambda[e] * edge_direction(r, a, b, length);
        force.row(a) += pull;
        force.row(b) -= pull;
        const double stretch = length / model.edge_max_length[e] - 1.0;
        overstretch = std::max(overstretch, stretch);
        complementarity = std::max(complementarity, lambda[e] * std::abs(stretch));
        negative = std::max(negative, -lambda[e]);
    }
    if (!(size > 0.0)) return overstretch;
    return std::max({overstretch, force.cwiseAbs().maxCoeff() / size, complementarity / size, negative / size});
}

}  // namespace toile::prior

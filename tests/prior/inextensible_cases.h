#pragma once

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "prior/inextensibility.h"

namespace toile::prior::test {

/// A model and where its cloth rests: every limit is the length of the edge in `rest`.
struct InextensibleCase {
    InextensibilityModel model;
    Positions rest;  ///< `[V x 3]`

    std::vector<double> at_rest() const { return {rest.data(), rest.data() + rest.size()}; }
};

inline InextensibleCase case_of(const Positions& rest, const std::vector<std::pair<int, int>>& edges) {
    InextensibleCase result;
    result.rest = rest;
    InextensibilityModel& model = result.model;
    model.vertex_count = static_cast<int>(rest.rows());
    model.edge.resize(static_cast<Eigen::Index>(edges.size()), 2);
    model.edge_max_length.resize(model.edge.rows());
    model.target_stiffness = Eigen::VectorXd::Ones(rest.rows());
    for (Eigen::Index e = 0; e < model.edge.rows(); ++e) {
        model.edge.row(e) << edges[e].first, edges[e].second;
        model.edge_max_length[e] = (rest.row(edges[e].first) - rest.row(edges[e].second)).norm();
    }
    return result;
}

/// A flat patch of `columns` x `rows` vertices, squares of side `side` with one diagonal, shaken in its plane by
/// `shake` of the side.
inline InextensibleCase patch(int columns, int rows, double side = 0.02, double shake = 0.0, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-shake, shake);
    Positions rest(columns * rows, 3);
    std::vector<std::pair<int, int>> edges;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const int at = j * columns + i;
            const double x = i + uniform(random), y = j + uniform(random);
            rest.row(at) << side * x, side * y, 0.0;
            if (i + 1 < columns) edges.emplace_back(at, at + 1);
            if (j + 1 < rows) edges.emplace_back(at, at + columns);
            if (i + 1 < columns && j + 1 < rows) edges.emplace_back(at + 1, at + columns);
        }
    return case_of(rest, edges);
}

inline std::vector<double> with_noise(std::vector<double> position, double size, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, size);
    for (double& x : position) x += normal(random);
    return position;
}

inline std::vector<double> random_vector(size_t size, unsigned seed) {
    return with_noise(std::vector<double>(size, 0.0), 1.0, seed);
}

/// The contract's residual, written a second time and differently: as dense matrices.
inline double dense_residual(const InextensibilityModel& model, const std::vector<double>& predicted,
                             const std::vector<double>& position, const std::vector<double>& multiplier) {
    const Eigen::Index size = 3 * model.vertex_count;
    const Eigen::Map<const Eigen::VectorXd> r(position.data(), size), r_hat(predicted.data(), size);
    Eigen::VectorXd spring(size);
    for (Eigen::Index i = 0; i < size; ++i) spring[i] = model.target_stiffness[i / 3] * (r[i] - r_hat[i]);
    Eigen::VectorXd lambda = Eigen::Map<const Eigen::VectorXd>(multiplier.data(), model.edge.rows());
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(model.edge.rows(), size);
    Eigen::VectorXd length(model.edge.rows());
    for (Eigen::Index e = 0; e < model.edge.rows(); ++e) {
        const int a = model.edge(e, 0), b = model.edge(e, 1);
        const Eigen::Vector3d along = r.segment<3>(3 * a) - r.segment<3>(3 * b);
        length[e] = along.norm();
        if (length[e] == 0.0) continue;
        jacobian.block<1, 3>(e, 3 * a) = along.transpose() / length[e];
        jacobian.block<1, 3>(e, 3 * b) = -along.transpose() / length[e];
    }
    const Eigen::ArrayXd stretch = length.array() / model.edge_max_length.array() - 1.0;
    const double s = std::max(lambda.maxCoeff(), spring.lpNorm<Eigen::Infinity>());
    double residual = std::max(0.0, stretch.maxCoeff());
    if (s == 0.0) return residual;
    residual = std::max(residual, (spring + jacobian.transpose() * lambda).lpNorm<Eigen::Infinity>() / s);
    residual = std::max(residual, (lambda.array() * stretch.abs()).maxCoeff() / s);
    return std::max(residual, -lambda.minCoeff() / s);
}

}  // namespace toile::prior::test

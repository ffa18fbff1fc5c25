#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "prior/quasistatic.h"

namespace toile::prior::test {

/// A patch of `columns` x `rows` vertices in triangles of side `side`, shaken in its plane by `shake` of the side.
inline ClothMesh sheet(int columns, int rows, double side = 0.02, double shake = 0.15, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-shake, shake);
    ClothMesh mesh;
    mesh.rest_position.resize(columns * rows, 3);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double x = i + 0.5 * (j % 2) + uniform(random), y = 0.866 * j + uniform(random);
            mesh.rest_position.row(j * columns + i) << side * x, side * y, 0.0;
        }
    mesh.triangle.resize(2 * (columns - 1) * (rows - 1), 3);
    int f = 0;
    for (int j = 0; j + 1 < rows; ++j)
        for (int i = 0; i + 1 < columns; ++i) {
            const int a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
            if (j % 2 == 0) {
                mesh.triangle.row(f++) << a, b, c;
                mesh.triangle.row(f++) << b, d, c;
            } else {
                mesh.triangle.row(f++) << a, d, c;
                mesh.triangle.row(f++) << a, b, d;
            }
        }
    return mesh;
}

/// The sheet rolled along x without stretch: a curve of slope angle amplitude · sin(2π x / wave) + roll · x.
inline std::vector<double> draped(const ClothMesh& mesh, double amplitude = 1.0, double wave = 0.15,
                                  double roll = 2.0) {
    std::vector<double> position;
    for (Eigen::Index v = 0; v < mesh.rest_position.rows(); ++v) {
        const double end = mesh.rest_position(v, 0);
        constexpr int steps = 400;
        double x = 0.0, z = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double s = end * (i + 0.5) / steps;
            const double angle = amplitude * std::sin(2.0 * 3.14159265358979 * s / wave) + roll * s;
            x += end / steps * std::cos(angle);
            z += end / steps * std::sin(angle);
        }
        position.insert(position.end(), {x, mesh.rest_position(v, 1), z});
    }
    return position;
}

inline std::vector<double> at_rest(const ClothMesh& mesh) {
    return {mesh.rest_position.data(), mesh.rest_position.data() + mesh.rest_position.size()};
}

inline std::vector<double> noisy(std::vector<double> position, double size, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, size);
    for (double& x : position) x += normal(random);
    return position;
}

inline std::vector<double> random_numbers(size_t count, unsigned seed) {
    return noisy(std::vector<double>(count, 0.0), 1.0, seed);
}

inline std::vector<double> joined(const std::vector<std::vector<double>>& samples) {
    std::vector<double> all;
    for (const std::vector<double>& one : samples) all.insert(all.end(), one.begin(), one.end());
    return all;
}

inline std::vector<double> sample_of(const std::vector<double>& batch, size_t size, size_t i) {
    return {batch.begin() + static_cast<std::ptrdiff_t>(i * size),
            batch.begin() + static_cast<std::ptrdiff_t>((i + 1) * size)};
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

inline QuasistaticSolution projected(const Quasistatic& prior, const std::vector<double>& predicted) {
    Quasistatic::Workspace workspace(prior);
    QuasistaticSolution solution;
    prior.project(predicted, solution, workspace);
    return solution;
}

/// The energy, written a second time from the model as it stands.
inline double dense_energy(const QuasistaticModel& model, const Eigen::VectorXd& predicted, const Eigen::VectorXd& r) {
    const auto at = [&r](int v) -> Eigen::Vector3d { return r.segment<3>(3 * v); };
    double energy = 0.0;
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); ++e) {
        const double length = (at(model.edge_spring(e, 0)) - at(model.edge_spring(e, 1))).norm();
        energy += 0.5 * model.edge_stiffness[e] * std::pow(length - model.edge_rest_length[e], 2);
    }
    for (Eigen::Index e = 0; e < model.bending_spring.rows(); ++e) {
        const double length = (at(model.bending_spring(e, 0)) - at(model.bending_spring(e, 1))).norm();
        energy += 0.5 * model.bending_stiffness[e] * std::pow(length - model.bending_rest_length[e], 2);
    }
    for (Eigen::Index e = 0; e < model.axial_spring.rows(); ++e) {
        const auto corner = model.axial_spring.row(e);
        const double u = model.axial_weight(e, 0), v = model.axial_weight(e, 1);
        const Eigen::Vector3d gap =
            (1.0 - u) * at(corner[0]) + u * at(corner[1]) - (1.0 - v) * at(corner[2]) - v * at(corner[3]);
        energy += 0.5 * model.axial_stiffness[e] * gap.squaredNorm();
    }
    for (int v = 0; v < model.vertex_count; ++v)
        energy += 0.5 * model.target_stiffness[v] * (at(v) - predicted.segment<3>(3 * v)).squaredNorm();
    return energy;
}

/// Its Hessian, exact, dense.
inline Eigen::MatrixXd dense_hessian(const QuasistaticModel& model, const Eigen::VectorXd& r) {
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(r.size(), r.size());
    const auto add_spring = [&](int a, int b, double k, double rest) {
        const Eigen::Vector3d d = r.segment<3>(3 * a) - r.segment<3>(3 * b), n = d.normalized();
        const Eigen::Matrix3d block =
            k * (Eigen::Matrix3d::Identity() - rest / d.norm() * (Eigen::Matrix3d::Identity() - n * n.transpose()));
        hessian.block<3, 3>(3 * a, 3 * a) += block;
        hessian.block<3, 3>(3 * b, 3 * b) += block;
        hessian.block<3, 3>(3 * a, 3 * b) -= block;
        hessian.block<3, 3>(3 * b, 3 * a) -= block;
    };
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); ++e)
        add_spring(model.edge_spring(e, 0), model.edge_spring(e, 1), model.edge_stiffness[e],
                   model.edge_rest_length[e]);
    for (Eigen::Index e = 0; e < model.bending_spring.rows(); ++e)
        add_spring(model.bending_spring(e, 0), model.bending_spring(e, 1), model.bending_stiffness[e],
                   model.bending_rest_length[e]);
    for (Eigen::Index e = 0; e < model.axial_spring.rows(); ++e) {
        const double u = model.axial_weight(e, 0), v = model.axial_weight(e, 1), weight[4] = {1.0 - u, u, v - 1.0, -v};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                hessian.block<3, 3>(3 * model.axial_spring(e, i), 3 * model.axial_spring(e, j)) +=
                    model.axial_stiffness[e] * weight[i] * weight[j] * Eigen::Matrix3d::Identity();
    }
    for (int v = 0; v < model.vertex_count; ++v)
        hessian.block<3, 3>(3 * v, 3 * v) += model.target_stiffness[v] * Eigen::Matrix3d::Identity();
    return hessian;
}

}  // namespace toile::prior::test

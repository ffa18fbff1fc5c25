#pragma once

#include <Eigen/QR>

#include "prior/inextensibility.h"

namespace toile::prior::test {

/// The paper's second-order cone program, letter by letter and dense: Equations 3-5 with their variables
/// x = (r, t, α) and cones Q^{3V+1}, Q^4, ..., and its solution made from (r*, λ).
struct PaperConeProgram {
    Eigen::VectorXd c, b, h;
    Eigen::MatrixXd a, g;
    Eigen::VectorXd x, y, z, s;
    std::vector<Eigen::Index> cone_start;  ///< where each cone begins in s and z; then the end

    PaperConeProgram(const InextensibilityModel& model, const std::vector<double>& predicted,
                     const std::vector<double>& position, const std::vector<double>& multiplier) {
        const Eigen::Index v = 3 * model.vertex_count, e_count = model.edge.rows(), cones = v + 1 + 4 * e_count;
        const Eigen::Map<const Eigen::VectorXd> r(position.data(), v), r_hat(predicted.data(), v);
        Eigen::VectorXd root(v);
        for (Eigen::Index i = 0; i < v; ++i) root[i] = std::sqrt(model.target_stiffness[i / 3]);
        const Eigen::VectorXd pull = root.cwiseProduct(r - r_hat);
        const double t = pull.norm();

        c = Eigen::VectorXd::Unit(v + 1 + e_count, v);
        a = Eigen::MatrixXd::Zero(e_count, v + 1 + e_count);
        a.rightCols(e_count).setIdentity();
        b = model.edge_max_length;
        g = Eigen::MatrixXd::Zero(cones, v + 1 + e_count);
        h = Eigen::VectorXd::Zero(cones);
        g(0, v) = -1.0;
        g.block(1, 0, v, v).diagonal() = -root;
        h.segment(1, v) = -root.cwiseProduct(r_hat);
        x.resize(v + 1 + e_count);
        x << r, t, model.edge_max_length;
        y.resize(e_count);
        z = s = Eigen::VectorXd::Zero(cones);
        s[0] = t;
        s.segment(1, v) = pull;
        z[0] = 1.0;
        z.segment(1, v) = -pull / t;
        cone_start = {0};
        for (Eigen::Index e = 0; e < e_count; ++e) {
            const Eigen::Index row = v + 1 + 4 * e, from = 3 * model.edge(e, 0), to = 3 * model.edge(e, 1);
            g(row, v + 1 + e) = -1.0;
            for (int k = 0; k < 3; ++k) {
                g(row + 1 + k, from + k) = -1.0;
                g(row + 1 + k, to + k) = 1.0;
            }
            const Eigen::Vector3d along = r.segment<3>(from) - r.segment<3>(to);
            s[row] = model.edge_max_length[e];
            s.segment<3>(row + 1) = along;
            z[row] = y[e] = multiplier[e] / t;
            z.segment<3>(row + 1) = -z[row] * along.normalized();
            cone_start.push_back(row);
        }
        cone_start.push_back(cones);
    }

    /// The matrix of q ∘ (.) over all cones (Equation 9).
    Eigen::MatrixXd product_matrix(const Eigen::VectorXd& q) const {
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(q.size(), q.size());
        for (size_t k = 0; k + 1 < cone_start.size(); ++k) {
            const Eigen::Index begin = cone_start[k], size = cone_start[k + 1] - begin;
            matrix.block(begin, begin, size, size).diagonal().setConstant(q[begin]);
            matrix.block(begin, begin + 1, 1, size - 1) = q.segment(begin + 1, size - 1).transpose();
            matrix.block(begin + 1, begin, size - 1, 1) = q.segment(begin + 1, size - 1);
        }
        return matrix;
    }

    /// dr of Equation 7 for a change of r̂ and of the limits, in the sense of least norm.
    Eigen::VectorXd position_change(const InextensibilityModel& model, const Eigen::VectorXd& predicted_change,
                                    const Eigen::VectorXd& limit_change) const {
        const Eigen::Index nx = x.size(), ny = y.size(), ns = s.size(), v = 3 * model.vertex_count;
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(nx + ny + 2 * ns, nx + ny + 2 * ns);
        matrix.block(0, nx, nx, ny) = a.transpose();
        matrix.block(0, nx + ny, nx, ns) = g.transpose();
        matrix.block(nx, 0, ny, nx) = a;
        matrix.block(nx + ny, 0, ns, nx) = g;
        matrix.block(nx + ny, nx + ny + ns, ns, ns).setIdentity();
        matrix.block(nx + ny + ns, nx + ny, ns, ns) = product_matrix(s);
        matrix.block(nx + ny + ns, nx + ny + ns, ns, ns) = product_matrix(z);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix.rows());
        right.segment(nx, ny) = limit_change;
        for (Eigen::Index i = 0; i < v; ++i)
            right[nx + ny + 1 + i] = -std::sqrt(model.target_stiffness[i / 3]) * predicted_change[i];
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
        decomposition.setThreshold(1e-9);
        decomposition.compute(matrix);
        return decomposition.solve(right).head(v);
    }
};

}  // namespace toile::prior::test

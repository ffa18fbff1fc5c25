#pragma once

#include <Eigen/Core>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cloth/block_symbolic.h"
#include "cloth/lane_array.h"

namespace toile {

struct VertexGraph {
    std::string name;
    int vertex_count;
    std::vector<std::pair<int, int>> pairs;
};

/// Edges of a triangulated grid; `around` closes it to a tube.
inline VertexGraph grid_graph(const std::string& name, int columns, int rows, bool around) {
    VertexGraph graph{name, columns * rows, {}};
    const auto add = [&](int i, int j, int k, int l) {
        if (l >= rows || (k >= columns && !around)) return;
        graph.pairs.emplace_back(i + columns * j, k % columns + columns * l);
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            add(i, j, i + 1, j);
            add(i, j, i, j + 1);
            add(i, j, i + 1, j + 1);
        }
    return graph;
}

inline std::vector<VertexGraph> vertex_graphs() {
    std::vector<VertexGraph> graphs;
    graphs.push_back({"one vertex", 1, {}});
    graphs.push_back({"isolated vertices", 5, {}});
    graphs.push_back({"path", 40, {}});
    for (int i = 0; i + 1 < 40; ++i) graphs.back().pairs.emplace_back(i, i + 1);
    graphs.push_back({"star", 30, {}});
    for (int i = 0; i < 30; ++i) graphs.back().pairs.emplace_back(i, 13);
    graphs.push_back({"all pairs", 40, {}});
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j) graphs.back().pairs.emplace_back(i, j);
    graphs.push_back(grid_graph("grid", 13, 17, false));
    graphs.push_back(grid_graph("tube", 12, 15, true));
    // Two components and vertices of no pair, in mixed order.
    graphs.push_back({"disconnected", 60, {}});
    for (const auto& [i, j] : grid_graph("", 5, 5, false).pairs)
        graphs.back().pairs.emplace_back(i * 17 % 60, j * 17 % 60);
    for (const auto& [i, j] : grid_graph("", 3, 7, true).pairs)
        graphs.back().pairs.emplace_back((i + 30) * 17 % 60, (j + 30) * 17 % 60);
    return graphs;
}

/// Random blocks `[slot][9]` of a positive definite matrix that is no multiple of a scalar one.
inline std::vector<double> positive_definite_blocks(const BlockSymbolic& symbolic, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    std::vector<double> blocks(9 * static_cast<size_t>(symbolic.slot_count()), 0.0);
    const auto block = [&](int slot) {
        return Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(blocks.data() + 9 * slot);
    };
    for (int v = 0; v < symbolic.vertex_count(); ++v) block(v) = 0.1 * Eigen::Matrix3d::Identity();
    for (int k = 0; k < static_cast<int>(symbolic.pair().size()); ++k) {
        // |P x_i + Q x_j|² is positive semidefinite, and its off-diagonal block PᵀQ is not symmetric.
        const auto [i, j] = symbolic.pair()[k];
        Eigen::Matrix3d p, q;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) p(r, c) = number(random), q(r, c) = number(random);
        block(i) += p.transpose() * p;
        block(j) += q.transpose() * q;
        block(symbolic.vertex_count() + k) = p.transpose() * q;
    }
    return blocks;
}

/// The matrix `[3V x 3V]` of blocks, in full.
inline Eigen::MatrixXd dense_matrix(const BlockSymbolic& symbolic, const std::vector<double>& blocks) {
    const int v = symbolic.vertex_count();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * v, 3 * v);
    for (int slot = 0; slot < symbolic.slot_count(); ++slot) {
        const auto [i, j] = slot < v ? std::pair(slot, slot) : symbolic.pair()[slot - v];
        const Eigen::Matrix3d block =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(blocks.data() + 9 * slot);
        dense.block<3, 3>(3 * i, 3 * j) = block;
        dense.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
    return dense;
}

inline LaneArray random_array(size_t size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    LaneArray array(size);
    for (size_t k = 0; k < size; ++k) array[k] = number(random);
    return array;
}

}  // namespace toile

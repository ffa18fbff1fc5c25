#include "cloth/block_matrix.h"

#include <algorithm>
#include <tuple>

#include "cloth/error.h"

namespace toile {

// The three scalar columns of vertex j start with the diagonal block's lower triangle, then hold three rows for each
// larger neighbour. A slot is the number of a neighbour within its column.

BlockMatrix::BlockMatrix(int vertex_count, std::vector<std::pair<int, int>> pairs) : vertex_count_(vertex_count) {
    for (auto& [i, j] : pairs) {
        if (i < j) std::swap(i, j);
        if (j < 0 || i >= vertex_count) throw Error("a vertex pair of a block matrix is out of range");
    }
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    std::sort(pairs.begin(), pairs.end(),
              [](const auto& a, const auto& b) { return std::tie(a.second, a.first) < std::tie(b.second, b.first); });
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

    neighbour_start_.assign(vertex_count + 1, 0);
    for (const auto& [i, j] : pairs) {
        ++neighbour_start_[j + 1];
        neighbour_.push_back(i);
    }
    for (int v = 0; v < vertex_count; ++v) neighbour_start_[v + 1] += neighbour_start_[v];

    column_start_.push_back(0);
    for (int j = 0; j < vertex_count; ++j) {
        for (int c = 0; c < 3; ++c) {
            for (int r = c; r < 3; ++r) row_.push_back(3 * j + r);
            for (int k = neighbour_start_[j]; k < neighbour_start_[j + 1]; ++k)
                for (int r = 0; r < 3; ++r) row_.push_back(3 * neighbour_[k] + r);
            column_start_.push_back(static_cast<int>(row_.size()));
        }
    }
    value_.assign(row_.size(), 0.0);
}

void BlockMatrix::set_zero() {
    std::fill(value_.begin(), value_.end(), 0.0);
}

int BlockMatrix::slot(int i, int j) const {
    const auto first = neighbour_.begin() + neighbour_start_[j], last = neighbour_.begin() + neighbour_start_[j + 1];
    const auto found = std::lower_bound(first, last, i);
    if (found == last || *found != i) throw Error("a block outside the matrix' vertex graph was asked for");
    return static_cast<int>(found - first);
}

void BlockMatrix::add_at(int slot, int j, const Eigen::Matrix3d& block) {
    for (int c = 0; c < 3; ++c) {
        double* entry = value_.data() + column_start_[3 * j + c] + (3 - c) + 3 * slot;
        for (int r = 0; r < 3; ++r) entry[r] += block(r, c);
    }
}

void BlockMatrix::add_identity_at(int slot, int j, double factor) {
    for (int c = 0; c < 3; ++c) value_[column_start_[3 * j + c] + (3 - c) + 3 * slot + c] += factor;
}

void BlockMatrix::add(int i, int j, const Eigen::Matrix3d& block) {
    if (i == j) {
        for (int c = 0; c < 3; ++c)
            for (int r = c; r < 3; ++r) value_[column_start_[3 * j + c] + r - c] += block(r, c);
    } else if (i > j) {
        add_at(slot(i, j), j, block);
    } else {
        add_at(slot(j, i), i, block.transpose());
    }
}

void BlockMatrix::add_identity(int i, int j, double factor) {
    if (i == j) {
        for (int c = 0; c < 3; ++c) value_[column_start_[3 * j + c]] += factor;
    } else {
        add_identity_at(slot(std::max(i, j), std::min(i, j)), std::min(i, j), factor);
    }
}

void BlockMatrix::fix(int vertex) {
    for (int c = 0; c < 3; ++c) {
        const int column = 3 * vertex + c;
        std::fill(value_.begin() + column_start_[column], value_.begin() + column_start_[column + 1], 0.0);
        value_[column_start_[column]] = 1.0;
    }
    for (int j = 0; j < vertex; ++j) {
        const auto first = neighbour_.begin() + neighbour_start_[j],
                   last = neighbour_.begin() + neighbour_start_[j + 1];
        const auto found = std::lower_bound(first, last, vertex);
        if (found == last || *found != vertex) continue;
        for (int c = 0; c < 3; ++c) {
            double* entry = value_.data() + column_start_[3 * j + c] + (3 - c) + 3 * (found - first);
            std::fill(entry, entry + 3, 0.0);
        }
    }
}

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y.setZero(size());
    for (int column = 0; column < size(); ++column) {
        int k = column_start_[column];
        double sum = value_[k] * x[column];
        for (++k; k < column_start_[column + 1]; ++k) {
            sum += value_[k] * x[row_[k]];
            y[row_[k]] += value_[k] * x[column];
        }
        y[column] += sum;
    }
}

}  // namespace toile

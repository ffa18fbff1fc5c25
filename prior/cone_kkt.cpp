#include "prior/cone_kkt.h"

#include <algorithm>
#include <limits>

namespace toile::prior {
namespace {

constexpr int kMaxRefinements = 4;
constexpr double kSolved = 1e-15;

int slot_of(const SparseMatrix& matrix, int row, int column) {
    const int* begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
    const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - matrix.innerIndexPtr());
}

}  // namespace

SparseMatrix ConeKkt::pattern_of(const Edges& edge, int vertex_count) {
    const int size = 3 * vertex_count + static_cast<int>(edge.rows());
    std::vector<Eigen::Triplet<double>> entry;
    entry.reserve(static_cast<size_t>(size + 9 * edge.rows()));
    for (int i = 0; i < size; ++i) entry.emplace_back(i, i, 1.0);
    for (int e = 0; e < edge.rows(); ++e) {
        const int a = edge(e, 0), b = edge(e, 1);
        for (int c = 0; c < 3; ++c) {
            entry.emplace_back(3 * std::max(a, b) + c, 3 * std::min(a, b) + c, 0.0);
            entry.emplace_back(3 * vertex_count + e, 3 * a + c, 0.0);
            entry.emplace_back(3 * vertex_count + e, 3 * b + c, 0.0);
        }
    }
    SparseMatrix matrix(size, size);
    matrix.setFromTriplets(entry.begin(), entry.end());
    return matrix;
}

ConeKkt::ConeKkt(const Edges& edge, int vertex_count)
    : vertex_count_(vertex_count), edge_(edge), matrix_(pattern_of(edge, vertex_count)), ldl_(matrix_) {
    for (int i = 0; i < matrix_.rows(); ++i) diagonal_slot_.push_back(slot_of(matrix_, i, i));
    for (int e = 0; e < edge.rows(); ++e) {
        const int a = edge(e, 0), b = edge(e, 1), row = 3 * vertex_count + e;
        std::array<int, 3> pair;
        std::array<int, 6> entry;
        for (int c = 0; c < 3; ++c) {
            pair[c] = slot_of(matrix_, 3 * std::max(a, b) + c, 3 * std::min(a, b) + c);
            entry[c] = slot_of(matrix_, row, 3 * a + c);
            entry[c + 3] = slot_of(matrix_, row, 3 * b + c);
        }
        pair_slot_.push_back(pair);
        row_slot_.push_back(entry);
    }
}

void ConeKkt::begin(const Eigen::VectorXd& stiffness) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    for (int i = 0; i < 3 * vertex_count_; ++i) matrix_.valuePtr()[diagonal_slot_[i]] = stiffness[i / 3];
}

void ConeKkt::set_edge(Eigen::Index e, double transverse, const Eigen::Vector3d& direction, double compliance) {
    double* value = matrix_.valuePtr();
    for (int c = 0; c < 3; ++c) {
        value[diagonal_slot_[3 * edge_(e, 0) + c]] += transverse;
        value[diagonal_slot_[3 * edge_(e, 1) + c]] += transverse;
        value[pair_slot_[e][c]] -= transverse;
        value[row_slot_[e][c]] = direction[c];
        value[row_slot_[e][c + 3]] = -direction[c];
    }
    value[diagonal_slot_[3 * vertex_count_ + e]] = -compliance;
}

bool ConeKkt::factor() {
    return ldl_.factor(matrix_);
}

double ConeKkt::solve(const Eigen::VectorXd& right, Eigen::VectorXd& solution) {
    const double size = right.cwiseAbs().maxCoeff();
    if (!(size > 0.0)) {
        solution.setZero(right.size());
        return 0.0;
    }
    ldl_.solve(right, solution);
    double error = std::numeric_limits<double>::infinity();
    for (int refinement = 0;; ++refinement) {
        residual_ = right;
        residual_.noalias() -= matrix_.selfadjointView<Eigen::Lower>() * solution;
        const double last = error;
        error = residual_.cwiseAbs().maxCoeff() / size;
        if (refinement > 0 && !(error < last)) {
            solution -= correction_;
            return last;
        }
        if (refinement == kMaxRefinements || error <= kSolved || error > 0.5 * last) return error;
        ldl_.solve(residual_, correction_);
        solution += correction_;
    }
}

}  // namespace toile::prior

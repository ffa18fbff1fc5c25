#include "prior/single_preconditioners.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace toile::prior {
namespace {

Eigen::Matrix3d symmetric(const double* d) {
    Eigen::Matrix3d block;
    block << d[0], d[1], d[3], d[1], d[2], d[4], d[3], d[4], d[5];
    return block;
}

double dot(const double* x, const double* y, int size) {
    double sum = 0.0;
    for (int i = 0; i < size; ++i) sum += x[i] * y[i];
    return sum;
}

}  // namespace

BlockJacobi::BlockJacobi(const SpringGraph& graph)
    : vertex_count_(graph.vertex_count), inverse_(9 * static_cast<size_t>(graph.vertex_count)) {}

void BlockJacobi::factor(const double*, const double* diagonal, const double*, double* lost_pivot) {
    *lost_pivot = 0.0;
    for (int v = 0; v < vertex_count_; ++v) {
        const Eigen::Matrix3d block = symmetric(diagonal + 6 * v);
        const Eigen::LLT<Eigen::Matrix3d> llt(block);
        Eigen::Map<Eigen::Matrix3d> inverse(inverse_.data() + 9 * v);
        if (llt.info() == Eigen::Success) {
            inverse = llt.solve(Eigen::Matrix3d::Identity());
        } else {
            *lost_pivot += 1.0;
            inverse = Eigen::Matrix3d::Identity() / block.diagonal().cwiseAbs().sum();
        }
    }
}

void BlockJacobi::solve(const double* r, double* z, double* r_dot_z) {
    for (int v = 0; v < vertex_count_; ++v)
        Eigen::Map<Eigen::Vector3d>(z + 3 * v) =
            Eigen::Map<const Eigen::Matrix3d>(inverse_.data() + 9 * v) * Eigen::Map<const Eigen::Vector3d>(r + 3 * v);
    *r_dot_z = dot(r, z, 3 * vertex_count_);
}

CompleteCholesky::CompleteCholesky(const SpringGraph& graph) : graph_(graph) {
    std::vector<std::pair<int, int>> pairs;
    for (int a = 0; a < graph.vertex_count; ++a)
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) pairs.emplace_back(graph.spring[s].other, a);
    const auto symbolic = std::make_shared<const BlockSymbolic>(graph.vertex_count, pairs);
    for (const auto& [b, a] : pairs) slot_.push_back(symbolic->slot(b, a));
    block_ = LaneArray(9 * static_cast<size_t>(symbolic->slot_count()));
    cholesky_ = std::make_unique<LaneCholesky<1>>(symbolic);
}

void CompleteCholesky::assemble(const double* form, const double* diagonal, bool exact) {
    for (int v = 0; v < graph_.vertex_count; ++v)
        Eigen::Map<Eigen::Matrix3d>(block_.data() + 9 * v) = symmetric(diagonal + 6 * v);
    for (size_t s = 0; s < slot_.size(); ++s) {
        const double axial = graph_.spring[s].axial, across = form[4 * s + 3] - axial;
        const Eigen::Map<const Eigen::Vector3d> m(form + 4 * s);
        Eigen::Map<Eigen::Matrix3d>(block_.data() + 9 * slot_[s]) =
            -m * m.transpose() - ((exact ? across : std::max(across, 0.0)) + axial) * Eigen::Matrix3d::Identity();
    }
}

void CompleteCholesky::factor(const double* form, const double* diagonal, const double* exact, double* lost_pivot) {
    assemble(form, diagonal, *exact > 0.0);
    *lost_pivot = cholesky_->factor(block_.data()).all() ? 0.0 : 1.0;
}

void CompleteCholesky::solve(const double* r, double* z, double* r_dot_z) {
    std::copy_n(r, 3 * graph_.vertex_count, z);
    cholesky_->solve(z);
    *r_dot_z = dot(r, z, 3 * graph_.vertex_count);
}

}  // namespace toile::prior

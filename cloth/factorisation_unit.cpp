#include "cloth/factorisation_unit.h"

#include <Eigen/CholmodSupport>
#include <iomanip>
#include <sstream>
#include <vector>

#include "cloth/error.h"

extern "C" void openblas_set_num_threads(int threads);

namespace toile {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

Matrix mesh_hessian(const Edges& edge, const Positions& position) {
    std::vector<Eigen::Triplet<double>> entry;
    const auto add = [&entry](int i, int j, const Eigen::Matrix3d& block) {
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) entry.emplace_back(3 * i + r, 3 * j + c, block(r, c));
    };
    const auto count = static_cast<int>(position.rows());
    for (int v = 0; v < count; ++v) add(v, v, Eigen::Matrix3d::Identity());
    for (Eigen::Index e = 0; e < edge.rows(); ++e) {
        const int a = edge(e, 0), b = edge(e, 1);
        const Eigen::Vector3d along = (position.row(a) - position.row(b)).normalized();
        const Eigen::Matrix3d block = 0.7 * along * along.transpose() + 0.3 * Eigen::Matrix3d::Identity();
        add(a, a, block);
        add(b, b, block);
        add(a, b, -block);
        add(b, a, -block);
    }
    Matrix matrix(3 * count, 3 * count);
    matrix.setFromTriplets(entry.begin(), entry.end());
    return matrix;
}

}  // namespace

struct FactorisationUnit::Impl {
    Matrix matrix, lower;
    Eigen::CholmodDecomposition<Matrix, Eigen::Lower> cholesky;

    Impl(const Edges& edge, const Positions& position)
        : matrix(mesh_hessian(edge, position)), lower(matrix.triangularView<Eigen::Lower>()) {
        openblas_set_num_threads(1);
        cholesky.analyzePattern(lower);
        if (cholesky.info() != Eigen::Success) throw Error("the unit's matrix could not be analysed");
    }
};

FactorisationUnit::FactorisationUnit(const Edges& edge, const Positions& position)
    : impl_(std::make_unique<Impl>(edge, position)) {}
FactorisationUnit::~FactorisationUnit() = default;
FactorisationUnit::FactorisationUnit(FactorisationUnit&&) noexcept = default;

bool FactorisationUnit::factor() {
    impl_->cholesky.factorize(impl_->lower);
    return impl_->cholesky.info() == Eigen::Success;
}

double FactorisationUnit::solve_error() {
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(impl_->matrix.rows(), -1.0, 2.0);
    const Eigen::VectorXd x = impl_->cholesky.solve(right);
    return (impl_->matrix * x - right).lpNorm<Eigen::Infinity>() / right.lpNorm<Eigen::Infinity>();
}

std::string FactorisationUnit::description() const {
    const cholmod_common& common = impl_->cholesky.cholmod();
    const int ordering = common.method[common.selected].ordering;
    std::ostringstream text;
    text << (ordering == CHOLMOD_AMD     ? "AMD, "
             : ordering == CHOLMOD_METIS ? "METIS, "
                                         : "another ordering, ")
         << std::setprecision(2) << 1e-6 * common.lnz << " M nonzeros";
    return text.str();
}

}  // namespace toile

#include "bench/factorisation_unit.h"

#include <cholmod.h>

#include <iomanip>
#include <sstream>
#include <utility>
#include <vector>

#include "cloth/block_matrix.h"
#include "cloth/error.h"
#include "cloth/sparse_cholesky.h"

extern "C" void openblas_set_num_threads(int threads);

namespace toile::bench {
namespace {

BlockMatrix mesh_hessian(const Edges& edge, const Positions& position) {
    std::vector<std::pair<int, int>> pairs;
    for (Eigen::Index e = 0; e < edge.rows(); ++e) pairs.emplace_back(edge(e, 0), edge(e, 1));
    BlockMatrix matrix(static_cast<int>(position.rows()), pairs);
    for (int v = 0; v < static_cast<int>(position.rows()); ++v) matrix.add_identity(v, v, 1.0);
    for (const auto& [a, b] : pairs) {
        const Eigen::Vector3d along = (position.row(a) - position.row(b)).normalized();
        const Eigen::Matrix3d block = 0.7 * along * along.transpose() + 0.3 * Eigen::Matrix3d::Identity();
        matrix.add(a, a, block);
        matrix.add(b, b, block);
        matrix.add(a, b, -block);
    }
    return matrix;
}

cholmod_sparse lower_triangle(const BlockMatrix& matrix) {
    cholmod_sparse sparse{};
    sparse.nrow = sparse.ncol = static_cast<size_t>(matrix.size());
    sparse.nzmax = matrix.row().size();
    sparse.p = const_cast<int*>(matrix.column_start().data());
    sparse.i = const_cast<int*>(matrix.row().data());
    sparse.x = const_cast<double*>(matrix.value().data());
    sparse.stype = -1;
    sparse.itype = CHOLMOD_INT;
    sparse.xtype = CHOLMOD_REAL;
    sparse.dtype = CHOLMOD_DOUBLE;
    sparse.sorted = sparse.packed = 1;
    return sparse;
}

}  // namespace

struct FactorisationUnit::Impl {
    BlockMatrix matrix;
    cholmod_common common;
    cholmod_sparse sparse;
    cholmod_factor* factor = nullptr;
    std::unique_ptr<SparseCholesky> toile;

    Impl(const Edges& edge, const Positions& position, Settings settings)
        : matrix(mesh_hessian(edge, position)), sparse(lower_triangle(matrix)) {
        cholmod_start(&common);
        openblas_set_num_threads(1);
        if (settings == Settings::toile)
            toile = std::make_unique<SparseCholesky>(matrix);
        else
            factor = cholmod_analyze(&sparse, &common);
        if (settings != Settings::toile && !factor) throw Error("the unit's matrix could not be analysed");
    }
    ~Impl() {
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    Eigen::VectorXd solve(const Eigen::VectorXd& right) {
        Eigen::VectorXd x(right.size());
        if (toile) {
            toile->solve(right, x);
            return x;
        }
        cholmod_dense dense{};
        dense.nrow = dense.nzmax = dense.d = static_cast<size_t>(right.size());
        dense.ncol = 1;
        dense.x = const_cast<double*>(right.data());
        dense.xtype = CHOLMOD_REAL;
        dense.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor, &dense, &common);
        if (!solution) throw Error("the unit's matrix could not be solved with");
        x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(solution->x), right.size());
        cholmod_free_dense(&solution, &common);
        return x;
    }
};

FactorisationUnit::FactorisationUnit(const Edges& edge, const Positions& position, Settings settings)
    : impl_(std::make_unique<Impl>(edge, position, settings)) {}
FactorisationUnit::~FactorisationUnit() = default;
FactorisationUnit::FactorisationUnit(FactorisationUnit&&) noexcept = default;

bool FactorisationUnit::factor() {
    if (impl_->toile) return impl_->toile->factor(impl_->matrix);
    return cholmod_factorize(&impl_->sparse, impl_->factor, &impl_->common) != 0 &&
           impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

double FactorisationUnit::solve_error() {
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(impl_->matrix.size(), -1.0, 2.0);
    Eigen::VectorXd product;
    impl_->matrix.multiply(impl_->solve(right), product);
    return (product - right).lpNorm<Eigen::Infinity>() / right.lpNorm<Eigen::Infinity>();
}

std::string FactorisationUnit::description() const {
    const cholmod_factor* factor = impl_->factor;
    const double nonzeros = impl_->toile ? impl_->toile->factor_nonzeros() : impl_->common.lnz;
    std::ostringstream text;
    text << (impl_->toile || factor->is_super ? "supernodal, " : "simplicial, ")
         << (impl_->toile || factor->ordering == CHOLMOD_AMD ? "AMD, "
             : factor->ordering == CHOLMOD_METIS             ? "METIS, "
                                                             : "another ordering, ")
         << std::setprecision(2) << 1e-6 * nonzeros << " M nonzeros";
    return text.str();
}

}  // namespace toile::bench

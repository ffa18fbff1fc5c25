#include "prior/quasidefinite_ldl.h"

#include <cholmod.h>

#include <algorithm>
#include <cmath>

#include "cloth/error.h"

namespace toile::prior {

struct QuasidefiniteLdl::Impl {
    cholmod_common common;
    cholmod_factor* factor = nullptr;
    cholmod_dense* solution = nullptr;
    cholmod_dense* work_y = nullptr;
    cholmod_dense* work_e = nullptr;
    Eigen::Index size = 0;
    Eigen::Index nonzeros = 0;

    Impl() {
        cholmod_start(&common);
        common.supernodal = CHOLMOD_SIMPLICIAL;  // the supernodal code factors positive definite matrices only
        common.final_ll = 0;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_AMD;
        common.postorder = 1;
        common.error_handler = nullptr;
        common.print = 0;
    }
    ~Impl() {
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
};

namespace {

/// A view of the matrix as CHOLMOD sees it. CHOLMOD does not write to a matrix that it factors.
cholmod_sparse view(const SparseMatrix& matrix) {
    cholmod_sparse sparse{};
    sparse.nrow = sparse.ncol = static_cast<size_t>(matrix.rows());
    sparse.nzmax = static_cast<size_t>(matrix.nonZeros());
    sparse.p = const_cast<int*>(matrix.outerIndexPtr());
    sparse.i = const_cast<int*>(matrix.innerIndexPtr());
    sparse.x = const_cast<double*>(matrix.valuePtr());
    sparse.stype = -1;
    sparse.itype = CHOLMOD_INT;
    sparse.xtype = CHOLMOD_REAL;
    sparse.dtype = CHOLMOD_DOUBLE;
    sparse.sorted = 1;
    sparse.packed = 1;
    return sparse;
}

}  // namespace

QuasidefiniteLdl::QuasidefiniteLdl(const SparseMatrix& pattern) : impl_(std::make_unique<Impl>()) {
    if (!pattern.isCompressed() || pattern.rows() != pattern.cols())
        throw Error("the matrix to analyse for LDL' is not square and compressed");
    cholmod_sparse matrix = view(pattern);
    impl_->factor = cholmod_analyze(&matrix, &impl_->common);
    if (!impl_->factor) throw Error("the matrix could not be analysed for LDL': out of memory");
    impl_->size = pattern.rows();
    impl_->nonzeros = pattern.nonZeros();
}

QuasidefiniteLdl::~QuasidefiniteLdl() = default;
QuasidefiniteLdl::QuasidefiniteLdl(QuasidefiniteLdl&&) noexcept = default;
QuasidefiniteLdl& QuasidefiniteLdl::operator=(QuasidefiniteLdl&&) noexcept = default;

bool QuasidefiniteLdl::factor(const SparseMatrix& matrix) {
    if (!matrix.isCompressed() || matrix.rows() != impl_->size || matrix.nonZeros() != impl_->nonzeros)
        throw Error("the matrix to factor has another pattern than the one that was analysed");
    const double* value = matrix.valuePtr();
    if (!std::all_of(value, value + matrix.nonZeros(), [](double x) { return std::isfinite(x); })) return false;
    cholmod_sparse sparse = view(matrix);
    cholmod_factorize(&sparse, impl_->factor, &impl_->common);
    if (impl_->common.status < CHOLMOD_OK) throw Error("LDL' ran out of memory");
    return impl_->common.status == CHOLMOD_OK && impl_->factor->minor == static_cast<size_t>(impl_->size);
}

void QuasidefiniteLdl::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    if (b.size() != impl_->size) throw Error("the right-hand side does not fit the factored matrix");
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = static_cast<size_t>(b.size());
    right.ncol = 1;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, impl_->factor, &right, nullptr, &impl_->solution, nullptr, &impl_->work_y, &impl_->work_e,
                   &impl_->common);
    x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(impl_->solution->x), b.size());
}

double QuasidefiniteLdl::factor_nonzeros() const {
    return impl_->common.lnz;
}

}  // namespace toile::prior

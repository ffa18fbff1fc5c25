#include "cloth/sparse_cholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <cmath>

#include "cloth/error.h"

// OpenBLAS is called by CHOLMOD; these two are in its library but not in the standard headers.
extern "C" void openblas_set_num_threads(int threads);
extern "C" int openblas_get_parallel(void);

namespace toile {
namespace {

/// One thread for each factorisation, so that its sums do not depend on how many there are: toile runs samples in
/// parallel.
void use_one_thread() {
    if (openblas_get_parallel() == 0)
        throw Error("this OpenBLAS is built without locks and would spoil results when two threads call it", {},
                    "install the Debian package libopenblas0-pthread and remove libopenblas0-serial");
    openblas_set_num_threads(1);
}

}  // namespace

struct SparseCholesky::Impl {
    cholmod_common common;
    cholmod_factor* factor = nullptr;
    cholmod_dense* solution = nullptr;
    cholmod_dense* work_y = nullptr;
    cholmod_dense* work_e = nullptr;
    int size = 0;
    size_t nonzeros = 0;

    Impl() {
        static const bool once = (use_one_thread(), true);
        static_cast<void>(once);
        cholmod_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.nmethods = 1;
        // Not METIS: its ordering depends on the process's random numbers, and with it the last bits of a drape.
        common.method[0].ordering = CHOLMOD_AMD;
        common.postorder = 1;
        // Wider supernodes than CHOLMOD's default: a third less time for a cloth's Hessian with hinges (3,000
        // vertices).
        common.nrelax[0] = 12;
        common.nrelax[1] = 48;
        common.nrelax[2] = 96;
        common.zrelax[0] = 0.9;
        common.zrelax[1] = 0.3;
        common.zrelax[2] = 0.1;
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
cholmod_sparse view(const BlockMatrix& matrix) {
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
    sparse.sorted = 1;
    sparse.packed = 1;
    return sparse;
}

cholmod_dense view(const Eigen::VectorXd& vector) {
    cholmod_dense dense{};
    dense.nrow = dense.nzmax = dense.d = static_cast<size_t>(vector.size());
    dense.ncol = 1;
    dense.x = const_cast<double*>(vector.data());
    dense.xtype = CHOLMOD_REAL;
    dense.dtype = CHOLMOD_DOUBLE;
    return dense;
}

}  // namespace

SparseCholesky::SparseCholesky(const BlockMatrix& pattern) : impl_(std::make_unique<Impl>()) {
    cholmod_sparse matrix = view(pattern);
    impl_->factor = cholmod_analyze(&matrix, &impl_->common);
    if (!impl_->factor) throw Error("the matrix could not be analysed for Cholesky: out of memory");
    impl_->size = pattern.size();
    impl_->nonzeros = pattern.row().size();
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;

bool SparseCholesky::factor(const BlockMatrix& matrix) {
    if (matrix.size() != impl_->size || matrix.row().size() != impl_->nonzeros)
        throw Error("the matrix to factor has another pattern than the one that was analysed");
    if (!std::all_of(matrix.value().begin(), matrix.value().end(), [](double x) { return std::isfinite(x); }))
        throw Error("the matrix to factor is not finite");
    cholmod_sparse sparse = view(matrix);
    cholmod_factorize(&sparse, impl_->factor, &impl_->common);
    if (impl_->common.status < CHOLMOD_OK) throw Error("Cholesky ran out of memory");
    return impl_->common.status == CHOLMOD_OK && impl_->factor->minor == static_cast<size_t>(impl_->size);
}

void SparseCholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    if (b.size() != impl_->size) throw Error("the right-hand side does not fit the factored matrix");
    cholmod_dense right = view(b);
    cholmod_solve2(CHOLMOD_A, impl_->factor, &right, nullptr, &impl_->solution, nullptr, &impl_->work_y, &impl_->work_e,
                   &impl_->common);
    x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(impl_->solution->x), b.size());
}

double SparseCholesky::factor_nonzeros() const {
    return impl_->common.lnz;
}

}  // namespace toile

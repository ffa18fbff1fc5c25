#include "cloth/scalar_cholesky.h"

#include <cmath>

#include "cloth/error.h"
#include "cloth/lane_array.h"
#include "cloth/lane_panel.h"

namespace toile {
namespace {

using panel::EightSamples;
using panel::Four;
using panel::OneSample;
using panel::Two;

/// A factored panel, `[height][width]` with reciprocal pivots, and the vertices of its rows, its own columns first.
struct SolveTask {
    const double* panel;
    int width, height;
    const int* vertex;
};

/// x_i -= Σ_d L_id x_d for ROWS rows i and the first `depth` columns.
template <class S, int ROWS>
[[gnu::always_inline]] inline void subtract_rows(const SolveTask& t, int i, int depth,
                                                 const typename S::Vector (*own)[S::parts], double* x) {
    typename S::Vector sum[ROWS][S::parts] = {};
    for (int k = 0; k < ROWS; ++k) S::load_row(x + 3L * S::lanes * t.vertex[i + k], sum[k]);
    const double* left = t.panel + static_cast<long>(i) * t.width;
    for (int d = 0; d < depth; ++d)
        for (int k = 0; k < ROWS; ++k)
            for (int r = 0; r < S::parts; ++r) sum[k][r] -= left[k * t.width + d] * own[d][r];
    for (int k = 0; k < ROWS; ++k) S::store_row(x + 3L * S::lanes * t.vertex[i + k], sum[k]);
}

template <class S>
[[gnu::always_inline]] inline void solve_forward(const SolveTask& t, double* x) {
    constexpr int rows = 4;
    for (int lane = 0; lane < S::lanes; lane += S::pass, x += S::pass) {
        typename S::Vector own[BlockSymbolic::max_width][S::parts];
        for (int i = 0; i < t.width; ++i) {
            subtract_rows<S, 1>(t, i, i, own, x);
            double* place = x + 3L * S::lanes * t.vertex[i];
            S::load_row(place, own[i]);
            for (int r = 0; r < S::parts; ++r) own[i][r] *= t.panel[static_cast<long>(i) * t.width + i];
            S::store_row(place, own[i]);
        }
        int i = t.width;
        for (; i + rows <= t.height; i += rows) subtract_rows<S, rows>(t, i, t.width, own, x);
        for (; i < t.height; ++i) subtract_rows<S, 1>(t, i, t.width, own, x);
    }
}

/// own_d -= Σ_i L_id x_i over the rows below, for COLUMNS columns d from `first` on.
template <class S, int COLUMNS>
[[gnu::always_inline]] inline void subtract_columns(const SolveTask& t, int first, const double* x,
                                                    typename S::Vector (*own)[S::parts]) {
    typename S::Vector sum[COLUMNS][S::parts] = {}, row[S::parts] = {};
    const double* left = t.panel + static_cast<long>(t.width) * t.width + first;
    for (int i = t.width; i < t.height; ++i, left += t.width) {
        S::load_row(x + 3L * S::lanes * t.vertex[i], row);
        for (int d = 0; d < COLUMNS; ++d)
            for (int r = 0; r < S::parts; ++r) sum[d][r] += left[d] * row[r];
    }
    for (int d = 0; d < COLUMNS; ++d)
        for (int r = 0; r < S::parts; ++r) own[first + d][r] -= sum[d][r];
}

template <class S>
[[gnu::always_inline]] inline void solve_backward(const SolveTask& t, double* x) {
    constexpr int columns = 4;
    for (int lane = 0; lane < S::lanes; lane += S::pass, x += S::pass) {
        typename S::Vector own[BlockSymbolic::max_width][S::parts];
        for (int i = 0; i < t.width; ++i) S::load_row(x + 3L * S::lanes * t.vertex[i], own[i]);
        int first = 0;
        for (; first + columns <= t.width; first += columns) subtract_columns<S, columns>(t, first, x, own);
        for (; first < t.width; ++first) subtract_columns<S, 1>(t, first, x, own);
        for (int i = t.width - 1; i >= 0; --i) {
            const double* left = t.panel + static_cast<long>(i) * t.width;
            for (int r = 0; r < S::parts; ++r) own[i][r] *= left[i];
            S::store_row(x + 3L * S::lanes * t.vertex[i], own[i]);
            for (int d = 0; d < i; ++d)
                for (int r = 0; r < S::parts; ++r) own[d][r] -= left[d] * own[i][r];
        }
    }
}

/// One instruction set's loops, each with its own register width.
struct Kernels {
    void (*forward)(const SolveTask&, double* x);
    void (*backward)(const SolveTask&, double* x);
};

#define TOILE_KERNELS(NAME, TARGET, SAMPLES)              \
    namespace NAME {                                      \
    TARGET void forward(const SolveTask& t, double* x) {  \
        solve_forward<SAMPLES>(t, x);                     \
    }                                                     \
    TARGET void backward(const SolveTask& t, double* x) { \
        solve_backward<SAMPLES>(t, x);                    \
    }                                                     \
    constexpr Kernels table{forward, backward};           \
    }

#if defined(__x86_64__)
TOILE_KERNELS(one_avx512, __attribute__((target("arch=x86-64-v4"))), OneSample)
TOILE_KERNELS(one_avx2, __attribute__((target("arch=x86-64-v3"))), OneSample)
TOILE_KERNELS(eight_avx512, __attribute__((target("arch=x86-64-v4"))), EightSamples<Lane8>)
TOILE_KERNELS(eight_avx2, __attribute__((target("arch=x86-64-v3"))), EightSamples<Four>)
#endif
TOILE_KERNELS(one_plain, , OneSample)
TOILE_KERNELS(eight_plain, , EightSamples<Two>)

template <int W>
const Kernels& pick_kernels() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("x86-64-v4")) return W == 1 ? one_avx512::table : eight_avx512::table;
    if (__builtin_cpu_supports("x86-64-v3")) return W == 1 ? one_avx2::table : eight_avx2::table;
#endif
    return W == 1 ? one_plain::table : eight_plain::table;
}

/// panel -= L(rows, K) L(columns, K)ᵀ for a descendant K.
void subtract_descendant(const BlockSymbolic& symbolic, const BlockSymbolic::Update& update, const double* source,
                         double* panel, int width) {
    const auto& descendant = symbolic.supernode()[update.descendant];
    const int depth = descendant.width();
    const int* target = symbolic.target().data() + update.target - update.first;
    for (int i = update.first; i < descendant.height(); ++i)
        for (int j = update.first; j < update.last && j <= i; ++j) {
            double sum = 0;
            for (int d = 0; d < depth; ++d)
                sum += source[static_cast<long>(i) * depth + d] * source[static_cast<long>(j) * depth + d];
            panel[static_cast<long>(target[i]) * width + target[j]] -= sum;
        }
}

/// Cholesky of an updated panel; false if a pivot is not positive.
bool factor_panel(double* panel, int width, int height) {
    for (int i = 0; i < height; ++i) {
        double* row = panel + static_cast<long>(i) * width;
        for (int j = 0; j < width && j <= i; ++j) {
            const double* other = panel + static_cast<long>(j) * width;
            for (int d = 0; d < j; ++d) row[j] -= row[d] * other[d];
            if (j < i) {
                row[j] *= other[j];
            } else {
                if (!(row[j] > 0) || !std::isfinite(row[j])) return false;
                row[j] = 1 / std::sqrt(row[j]);
            }
        }
    }
    return true;
}

}  // namespace

struct ScalarCholesky::Storage {
    const Kernels& one = pick_kernels<1>();
    const Kernels& eight = pick_kernels<8>();
    std::vector<std::size_t> panel_start;  // by supernode, into panel
    LaneArray panel;

    explicit Storage(const BlockSymbolic& symbolic) {
        std::size_t size = 0;
        for (const auto& s : symbolic.supernode()) {
            panel_start.push_back(size);
            size += static_cast<std::size_t>(s.height()) * s.width();
        }
        panel = LaneArray(size);
    }

    bool factor(const BlockSymbolic& symbolic, const std::vector<double>& value) {
        for (std::size_t j = 0; j < panel_start.size(); ++j) {
            const auto& s = symbolic.supernode()[j];
            double* const target = panel.data() + panel_start[j];
            for (int e = s.entry_begin; e < s.entry_end; ++e) {
                const auto& entry = symbolic.entry()[e];
                target[static_cast<long>(entry.row) * s.width() + entry.column] = value[entry.slot];
            }
            for (int u = s.update_begin; u < s.update_end; ++u) {
                const auto& update = symbolic.update()[u];
                subtract_descendant(symbolic, update, panel.data() + panel_start[update.descendant], target, s.width());
            }
            if (!factor_panel(target, s.width(), s.height())) return false;
        }
        return true;
    }
};

ScalarCholesky::ScalarCholesky(std::shared_ptr<const BlockSymbolic> symbolic, const std::vector<double>& value)
    : symbolic_(std::move(symbolic)) {
    if (value.size() != static_cast<std::size_t>(symbolic_->slot_count()))
        throw Error("a scalar matrix needs one value for each vertex and each pair of its graph");
    auto storage = std::make_unique<Storage>(*symbolic_);
    if (!storage->factor(*symbolic_, value)) throw Error("a scalar matrix to factor is not positive definite");
    storage_ = std::move(storage);
}
ScalarCholesky::~ScalarCholesky() = default;
ScalarCholesky::ScalarCholesky(ScalarCholesky&&) noexcept = default;
ScalarCholesky& ScalarCholesky::operator=(ScalarCholesky&&) noexcept = default;

template <int W>
void ScalarCholesky::solve(double* x) const {
    const Kernels& kernels = W == 1 ? storage_->one : storage_->eight;
    const auto task = [&](std::size_t k) {
        const auto& s = symbolic_->supernode()[k];
        return SolveTask{storage_->panel.data() + storage_->panel_start[k], s.width(), s.height(),
                         symbolic_->row_vertex().data() + s.row_begin};
    };
    const std::size_t count = symbolic_->supernode().size();
    for (std::size_t k = 0; k < count; ++k) kernels.forward(task(k), x);
    for (std::size_t k = count; k-- > 0;) kernels.backward(task(k), x);
}

template void ScalarCholesky::solve<1>(double* x) const;
template void ScalarCholesky::solve<8>(double* x) const;

std::size_t ScalarCholesky::storage_bytes() const {
    return storage_->panel.size() * sizeof(double) + storage_->panel_start.size() * sizeof(std::size_t);
}

}  // namespace toile

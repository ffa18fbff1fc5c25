#pragma once

#include "cloth/block_symbolic.h"
#include "cloth/lane_panel.h"

/// Triangular solves of `LaneCholesky` with one panel, for right-hand sides x where they lie: no permuted copy.
namespace toile::panel {

/// A factored panel and the vertices of its rows, its own columns first.
struct SolveTask {
    const double* panel;
    int width, height;
    const int* vertex;
    int sides;  ///< right-hand sides in x where it is `[V][3][sides]`
};

/// Eight samples, each with its own matrix: x is `[V][3][8]`.
template <class V>
struct SolveEightSamples : EightSamples<V> {
    using Number = V;  // of one scalar row
    static constexpr int stride = 8;
    static int sides(const SolveTask&) { return 8; }
    [[gnu::always_inline]] static V left(const double* column, int part) { return load<V>(column + 8 * part); }
    [[gnu::always_inline]] static V spread(V x) { return x; }
    [[gnu::always_inline]] static V sum(V x) { return x; }
    [[gnu::always_inline]] static V entry(const double* column, int r) { return left(column, r); }
    [[gnu::always_inline]] static void load_row(const double* x, int, V* row) { EightSamples<V>::load_row(x, row); }
    [[gnu::always_inline]] static void store_row(double* x, int, const V* row) { EightSamples<V>::store_row(x, row); }
};

/// One sample: x is `[V][3]`.
struct SolveOneSample : OneSample {
    using Number = double;
    static constexpr int stride = 1;
    static int sides(const SolveTask&) { return 1; }
    [[gnu::always_inline]] static Four left(const double* column, int) { return load<Four>(column); }
    [[gnu::always_inline]] static Four spread(double x) { return Four{x, x, x, x}; }
    [[gnu::always_inline]] static double sum(Four x) { return (x[0] + x[1]) + (x[2] + x[3]); }
    [[gnu::always_inline]] static double entry(const double* column, int r) { return column[r]; }
    [[gnu::always_inline]] static void load_row(const double* x, int, Four* row) { OneSample::load_row(x, row); }
    [[gnu::always_inline]] static void store_row(double* x, int, const Four* row) { OneSample::store_row(x, row); }
};

/// One sample's matrix, as many right-hand sides as V has lanes: x is `[V][3][sides]`.
template <class V>
struct SolveManySides {
    using Vector = V;
    using Number = V;
    static constexpr int lanes = sizeof(V) / sizeof(double), stride = lanes, column = 4, parts = 3, pass = lanes,
                         passes = 1;
    static int sides(const SolveTask& t) { return t.sides; }
    [[gnu::always_inline]] static V left(const double* block_column, int part) { return V{} + block_column[part]; }
    [[gnu::always_inline]] static V spread(V x) { return x; }
    [[gnu::always_inline]] static V sum(V x) { return x; }
    [[gnu::always_inline]] static V entry(const double* block_column, int r) { return left(block_column, r); }
    [[gnu::always_inline]] static void load_row(const double* x, int sides, V* row) {
        for (int r = 0; r < 3; ++r) row[r] = load<V>(x + r * sides);
    }
    [[gnu::always_inline]] static void store_row(double* x, int sides, const V* row) {
        for (int r = 0; r < 3; ++r) store<V>(x + r * sides, row[r]);
    }
};

/// x_i -= L_i x_own for ROWS block rows i, `depth` scalar columns long.
template <class S, int ROWS>
[[gnu::always_inline]] inline void subtract_rows(const SolveTask& t, int i, int depth, const double* own, double* x) {
    using V = typename S::Vector;
    const long row = 3L * t.width * S::column;
    V sum[ROWS][S::parts] = {};
    double* place[ROWS];
    const double* left[ROWS];
    for (int k = 0; k < ROWS; ++k) {
        place[k] = x + 3L * t.vertex[i + k] * S::sides(t);
        left[k] = t.panel + (i + k) * row;
        S::load_row(place[k], S::sides(t), sum[k]);
    }
    for (int d = 0; d < depth; ++d) {
        const V right = S::spread(load<typename S::Number>(own + d * S::stride));
        for (int k = 0; k < ROWS; ++k)
            for (int r = 0; r < S::parts; ++r) sum[k][r] -= S::left(left[k] + d * S::column, r) * right;
    }
    for (int k = 0; k < ROWS; ++k) S::store_row(place[k], S::sides(t), sum[k]);
}

/// L y = x for the panel's own rows, then x -= L y for those below.
template <class S, int ROWS>
[[gnu::always_inline]] inline void solve_forward(const SolveTask& t, double* x) {
    using N = typename S::Number;
    alignas(64) double own[3 * BlockSymbolic::max_width * S::stride];
    const long row = 3L * t.width * S::column;
    for (int lane = 0; lane < S::lanes; lane += S::pass) {
        SolveTask task = t;
        task.panel += lane;
        for (int i = 0; i < t.width; ++i) {
            subtract_rows<S, 1>(task, i, 3 * i, own, x + lane);
            double* place = x + lane + 3L * t.vertex[i] * S::sides(t);
            const double* l = task.panel + i * row + 3L * i * S::column;
            const int next = S::sides(t);
            const N y0 = load<N>(place) * S::entry(l, 0);
            const N y1 = (load<N>(place + next) - S::entry(l, 1) * y0) * S::entry(l + S::column, 1);
            const N y2 = (load<N>(place + 2 * next) - S::entry(l, 2) * y0 - S::entry(l + S::column, 2) * y1) *
                         S::entry(l + 2 * S::column, 2);
            const N y[3] = {y0, y1, y2};
            for (int r = 0; r < 3; ++r) {
                store<N>(place + r * next, y[r]);
                store<N>(own + (3 * i + r) * S::stride, y[r]);
            }
        }
        int i = t.width;
        for (; i + ROWS <= t.height; i += ROWS) subtract_rows<S, ROWS>(task, i, 3 * t.width, own, x + lane);
        for (; i < t.height; ++i) subtract_rows<S, 1>(task, i, 3 * t.width, own, x + lane);
    }
}

/// own -= L_belowᵀ x for COLUMNS scalar columns from `first` on.
template <class S, int COLUMNS>
[[gnu::always_inline]] inline void subtract_columns(const SolveTask& t, int first, const double* x, double* own) {
    using V = typename S::Vector;
    const long row = 3L * t.width * S::column;
    V sum[COLUMNS];
    for (int d = 0; d < COLUMNS; ++d) sum[d] = V{};
    const double* left = t.panel + t.width * row + first * S::column;
    for (int i = t.width; i < t.height; ++i, left += row) {
        V right[S::parts] = {};
        S::load_row(x + 3L * t.vertex[i] * S::sides(t), S::sides(t), right);
        for (int d = 0; d < COLUMNS; ++d)
            for (int r = 0; r < S::parts; ++r) sum[d] += S::left(left + d * S::column, r) * right[r];
    }
    using N = typename S::Number;
    for (int d = 0; d < COLUMNS; ++d) {
        double* y = own + (first + d) * S::stride;
        store<N>(y, load<N>(y) - S::sum(sum[d]));
    }
}

/// Lᵀ x = y for the panel's own rows, given x for those below.
template <class S, int COLUMNS>
[[gnu::always_inline]] inline void solve_backward(const SolveTask& t, double* x) {
    using N = typename S::Number;
    alignas(64) double own[3 * BlockSymbolic::max_width * S::stride];
    const long row = 3L * t.width * S::column;
    const int next = S::sides(t);
    for (int lane = 0; lane < S::lanes; lane += S::pass) {
        SolveTask task = t;
        task.panel += lane;
        for (int i = 0; i < t.width; ++i)
            for (int r = 0; r < 3; ++r)
                store<N>(own + (3 * i + r) * S::stride, load<N>(x + lane + 3L * t.vertex[i] * next + r * next));
        int first = 0;
        for (; first + COLUMNS <= 3 * t.width; first += COLUMNS)
            subtract_columns<S, COLUMNS>(task, first, x + lane, own);
        for (; first < 3 * t.width; first += 3) subtract_columns<S, 3>(task, first, x + lane, own);
        for (int i = t.width - 1; i >= 0; --i) {
            const double* l = task.panel + i * row + 3L * i * S::column;
            const double* y = own + 3 * i * S::stride;
            const N x2 = load<N>(y + 2 * S::stride) * S::entry(l + 2 * S::column, 2);
            const N x1 = (load<N>(y + S::stride) - S::entry(l + S::column, 2) * x2) * S::entry(l + S::column, 1);
            const N x0 = (load<N>(y) - S::entry(l, 1) * x1 - S::entry(l, 2) * x2) * S::entry(l, 0);
            double* place = x + lane + 3L * t.vertex[i] * next;
            store<N>(place, x0);
            store<N>(place + next, x1);
            store<N>(place + 2 * next, x2);
            const double* column = task.panel + i * row;
            for (int d = 0; d < 3 * i; ++d, column += S::column) {
                double* z = own + d * S::stride;
                store<N>(z,
                         load<N>(z) - S::entry(column, 0) * x0 - S::entry(column, 1) * x1 - S::entry(column, 2) * x2);
            }
        }
    }
}

}  // namespace toile::panel

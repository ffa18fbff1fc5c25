#pragma once

#include "cloth/block_symbolic.h"
#include "cloth/lane.h"

/// Inner loops of `LaneCholesky` on panels: the columns of one supernode, stored by block row. A block row holds, for
/// each scalar column, the three scalar rows: `[3 width][3][8]` for eight samples, `[3 width][4]` for one (three rows
/// and a zero, so that a column of a block is one register of four). Diagonal blocks hold reciprocal pivots.
///
/// Everything is always_inline, so that it is compiled for the instruction set of the function that it ends up in; V is
/// that set's widest register.
namespace toile::panel {

using Four = double __attribute__((vector_size(32)));
using Two = double __attribute__((vector_size(16)));

template <class V>
[[gnu::always_inline]] inline V load(const double* p) {
    V v;
    __builtin_memcpy(&v, p, sizeof(V));
    return v;
}
template <class V>
[[gnu::always_inline]] inline void store(double* p, V v) {
    __builtin_memcpy(p, &v, sizeof(V));
}

/// Keeps the compiler from reading v from memory again at each use: more loads than the processor does in the time.
template <class V>
[[gnu::always_inline]] inline void hold_in_register([[maybe_unused]] V& v) {
#if defined(__x86_64__)
    __asm__("" : "+v"(v));
#endif
}

/// Eight samples: three registers for a block's column (times `passes` where a register has fewer than eight lanes).
template <class V>
struct EightSamples {
    using Vector = V;
    static constexpr int lanes = 8, column = 24, parts = 3, part = 8;
    static constexpr int pass = sizeof(V) / sizeof(double), passes = 8 / pass;
    static constexpr bool fits_register = true, paired = false;
    /// Number in row r of a block's column, for all rows of another.
    [[gnu::always_inline]] static V factor(const double* block_column, int r) { return load<V>(block_column + 8 * r); }
    [[gnu::always_inline]] static void load_row(const double* x, V* row) {
        for (int r = 0; r < 3; ++r) row[r] = load<V>(x + 8 * r);
    }
    [[gnu::always_inline]] static void store_row(double* x, const V* row) {
        for (int r = 0; r < 3; ++r) store<V>(x + 8 * r, row[r]);
    }
};

/// One sample: one register of four for a block's column.
struct OneSample {
    using Vector = Four;
    static constexpr int lanes = 1, column = 4, parts = 1, part = 4;
    static constexpr int pass = 1, passes = 1;
    static constexpr bool fits_register = true, paired = false;
    [[gnu::always_inline]] static Four factor(const double* block_column, int r) {
        const double x = block_column[r];
        return Four{x, x, x, x};
    }
    [[gnu::always_inline]] static void load_row(const double* x, Four* row) { row[0] = Four{x[0], x[1], x[2], 0.0}; }
    [[gnu::always_inline]] static void store_row(double* x, const Four* row) {
        for (int r = 0; r < 3; ++r) x[r] = row[0][r];
    }
};

/// The same where a register has no four lanes.
struct OneSampleInPieces : OneSample {
    static constexpr bool fits_register = false;
};

/// The same with AVX-512: two block rows in one register, where there are two.
struct OneSampleInPairs : OneSample {
    static constexpr bool paired = true;
};

/// Puts blocks `[slot][9][lanes]` into their places in a panel of zeros.
template <class S>
[[gnu::always_inline]] inline void fill_panel(const BlockSymbolic::Entry* entry, int count, const double* blocks,
                                              double* panel, int width) {
    constexpr int W = S::lanes;
    for (int e = 0; e < count; ++e) {
        // Slots follow no order that the processor could guess.
        if (e + 4 < count)
            for (int line = 0; line < 9 * W * 8; line += 64)
                __builtin_prefetch(reinterpret_cast<const char*>(blocks + 9L * W * entry[e + 4].slot) + line);
        const double* block = blocks + 9L * W * entry[e].slot;
        double* place = panel + (static_cast<long>(entry[e].row) * width + entry[e].column) * 3 * S::column;
        const int row = entry[e].transposed ? W : 3 * W, column = entry[e].transposed ? 3 * W : W;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                store_lanes<W>(place + c * S::column + r * W, load_lanes<W>(block + r * row + c * column));
    }
}

#if defined(__x86_64__)
// By hand, as g++ 12 takes shuffles of these widths apart where a function is compiled for several instruction sets.
[[gnu::always_inline]] inline Lane8 load_pair(const double* first, const double* second) {
    Lane8 pair;
    __asm__("vmovupd %1, %t0\n\tvinsertf64x4 $1, %2, %0, %0"
            : "=&v"(pair)
            : "m"(*reinterpret_cast<const double(*)[4]>(first)), "m"(*reinterpret_cast<const double(*)[4]>(second)));
    return pair;
}
[[gnu::always_inline]] inline void store_pair(double* first, double* second, Lane8 pair) {
    __asm__("vmovupd %t1, %0" : "=m"(*reinterpret_cast<double(*)[4]>(first)) : "v"(pair));
    __asm__("vextractf64x4 $1, %1, %0" : "=m"(*reinterpret_cast<double(*)[4]>(second)) : "v"(pair));
}

/// `tile` for one sample and 2 PAIRS block rows.
template <int PAIRS>
[[gnu::always_inline]] inline void tile_in_pairs(double* const* c, const double* const* a, const double* b, int depth,
                                                 const double* pivot) {
    Lane8 sum[PAIRS][3];
    for (int i = 0; i < PAIRS; ++i)
        for (int k = 0; k < 3; ++k) sum[i][k] = load_pair(c[2 * i] + 4 * k, c[2 * i + 1] + 4 * k);
    for (int d = 0; d < depth; ++d) {
        Lane8 left[PAIRS];
        for (int i = 0; i < PAIRS; ++i) {
            left[i] = load_pair(a[2 * i] + 4 * d, a[2 * i + 1] + 4 * d);
            hold_in_register(left[i]);
        }
        for (int k = 0; k < 3; ++k) {
            const double right = b[4 * d + k];
            for (int i = 0; i < PAIRS; ++i) sum[i][k] -= left[i] * right;
        }
    }
    if (pivot)
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < PAIRS; ++i) {
                for (int m = 0; m < k; ++m) sum[i][k] -= sum[i][m] * pivot[4 * m + k];
                sum[i][k] *= pivot[4 * k + k];
            }
    for (int i = 0; i < PAIRS; ++i)
        for (int k = 0; k < 3; ++k) store_pair(c[2 * i] + 4 * k, c[2 * i + 1] + 4 * k, sum[i][k]);
}
#endif

/// c_i -= a_i bᵀ for ROWS blocks c_i of one block column; a_i and b are `depth` scalar columns long. If `pivot` is
/// given, the blocks are then divided by that diagonal block: c_i ← c_i L⁻ᵀ.
template <class S, int ROWS>
[[gnu::always_inline]] inline void tile(double* const* c, const double* const* a, const double* b, int depth,
                                        const double* pivot) {
    using V = typename S::Vector;
#if defined(__x86_64__)
    if constexpr (S::paired && ROWS % 2 == 0) return tile_in_pairs<ROWS / 2>(c, a, b, depth, pivot);
#endif
    for (int p = 0; p < S::passes; ++p) {
        const int lane = p * S::pass;
        V sum[ROWS][3][S::parts];
        for (int i = 0; i < ROWS; ++i)
            for (int k = 0; k < 3; ++k)
                for (int r = 0; r < S::parts; ++r) sum[i][k][r] = load<V>(c[i] + k * S::column + r * S::part + lane);
        const double* a_column[ROWS];
        for (int i = 0; i < ROWS; ++i) a_column[i] = a[i] + lane;
        const double* b_column = b + lane;
        for (int d = 0; d < depth; ++d) {
            V left[ROWS][S::parts];
            for (int i = 0; i < ROWS; ++i)
                for (int r = 0; r < S::parts; ++r) {
                    left[i][r] = load<V>(a_column[i] + d * S::column + r * S::part);
                    if constexpr (S::fits_register) hold_in_register(left[i][r]);
                }
            for (int k = 0; k < 3; ++k) {
                const V right = S::factor(b_column + d * S::column, k);
                for (int i = 0; i < ROWS; ++i)
                    for (int r = 0; r < S::parts; ++r) sum[i][k][r] -= left[i][r] * right;
            }
        }
        if (pivot)
            for (int k = 0; k < 3; ++k)
                for (int i = 0; i < ROWS; ++i)
                    for (int r = 0; r < S::parts; ++r) {
                        for (int m = 0; m < k; ++m)
                            sum[i][k][r] -= sum[i][m][r] * S::factor(pivot + m * S::column + lane, k);
                        sum[i][k][r] *= S::factor(pivot + k * S::column + lane, k);
                    }
        for (int i = 0; i < ROWS; ++i)
            for (int k = 0; k < 3; ++k)
                for (int r = 0; r < S::parts; ++r) store<V>(c[i] + k * S::column + r * S::part + lane, sum[i][k][r]);
    }
}

template <int W>
[[gnu::always_inline]] inline LaneMask<W> is_good_pivot(const Lane<W>& pivot) {
    return lane_less(lane_broadcast<W>(0.0), pivot) & lane_is_finite(pivot);
}
template <int W>
[[gnu::always_inline]] inline Lane<W> reciprocal_root(const Lane<W>& pivot, const LaneMask<W>& good) {
    return 1.0 / lane_sqrt(lane_select(good, pivot, lane_broadcast<W>(1.0)));
}

/// Cholesky of a diagonal block, in place; returns the mask of lanes with positive pivots. A pivot that is not is
/// replaced by 1.
template <class S>
[[gnu::always_inline]] inline LaneMask<S::lanes> factor_diagonal(double* block) {
    constexpr int W = S::lanes, column = S::column;
    double *const c0 = block, *const c1 = block + column, *const c2 = block + 2 * column;
    const Lane<W> d0 = load_lanes<W>(c0);
    const auto good0 = is_good_pivot<W>(d0);
    const Lane<W> p0 = reciprocal_root<W>(d0, good0);
    const Lane<W> l10 = load_lanes<W>(c0 + W) * p0, l20 = load_lanes<W>(c0 + 2 * W) * p0;
    const Lane<W> d1 = load_lanes<W>(c1 + W) - l10 * l10;
    const auto good1 = is_good_pivot<W>(d1);
    const Lane<W> p1 = reciprocal_root<W>(d1, good1);
    const Lane<W> l21 = (load_lanes<W>(c1 + 2 * W) - l20 * l10) * p1;
    const Lane<W> d2 = load_lanes<W>(c2 + 2 * W) - l20 * l20 - l21 * l21;
    const auto good2 = is_good_pivot<W>(d2);
    store_lanes<W>(c0, p0);
    store_lanes<W>(c0 + W, l10);
    store_lanes<W>(c0 + 2 * W, l20);
    store_lanes<W>(c1 + W, p1);
    store_lanes<W>(c1 + 2 * W, l21);
    store_lanes<W>(c2 + 2 * W, reciprocal_root<W>(d2, good2));
    return good0 & good1 & good2;
}

/// Where an update goes: from rows [first, height) of a descendant's panel into another panel.
struct UpdateTask {
    const double* source;
    int source_width;  // block columns
    int first, last, height;
    const int* target;  // block row for each row from `first` on
    double* panel;
    int width;  // block columns of the target
};

template <class S, int ROWS>
[[gnu::always_inline]] inline void update_rows(const UpdateTask& t, int i) {
    const long source_row = 3L * t.source_width * S::column, target_row = 3L * t.width * S::column;
    const double* a[ROWS];
    double* row[ROWS];
    for (int k = 0; k < ROWS; ++k) {
        a[k] = t.source + (i + k) * source_row;
        row[k] = t.panel + t.target[i + k - t.first] * target_row;
    }
    // Tiles above the diagonal are computed where ROWS takes them along; nobody reads them.
    const int end = i + ROWS < t.last ? i + ROWS : t.last;
    for (int j = t.first; j < end; ++j) {
        double* c[ROWS];
        for (int k = 0; k < ROWS; ++k) c[k] = row[k] + t.target[j - t.first] * 3L * S::column;
        tile<S, ROWS>(c, a, t.source + j * source_row, 3 * t.source_width, nullptr);
    }
}

/// panel -= L(rows, K) L(columns, K)ᵀ
template <class S, int ROWS>
[[gnu::always_inline]] inline void update_panel(const UpdateTask& t) {
    int i = t.first;
    for (; i + ROWS <= t.height; i += ROWS) update_rows<S, ROWS>(t, i);
    if constexpr (ROWS > 2)
        for (; i + 2 <= t.height; i += 2) update_rows<S, 2>(t, i);
    for (; i < t.height; ++i) update_rows<S, 1>(t, i);
}

template <class S, int ROWS>
[[gnu::always_inline]] inline void eliminate_rows(double* panel, int width, int i, int columns) {
    const long row = 3L * width * S::column;
    double* c[ROWS];
    const double* a[ROWS];
    for (int k = 0; k < ROWS; ++k) a[k] = panel + (i + k) * row;
    for (int j = 0; j < columns; ++j) {
        for (int k = 0; k < ROWS; ++k) c[k] = panel + (i + k) * row + 3L * j * S::column;
        const double* b = panel + j * row;
        tile<S, ROWS>(c, a, b, 3 * j, b + 3L * j * S::column);
    }
}

/// Cholesky of an updated panel; returns the mask of lanes with positive pivots.
template <class S, int ROWS>
[[gnu::always_inline]] inline LaneMask<S::lanes> factor_panel(double* panel, int width, int height) {
    const long row = 3L * width * S::column;
    LaneMask<S::lanes> good{};
    for (int i = 0; i < width; ++i) {
        eliminate_rows<S, 1>(panel, width, i, i);
        double* const diagonal = panel + i * row + 3L * i * S::column;
        const double* const a = panel + i * row;
        tile<S, 1>(&diagonal, &a, a, 3 * i, nullptr);
        const auto pivots = factor_diagonal<S>(diagonal);
        good = i == 0 ? pivots : good & pivots;
    }
    int i = width;
    for (; i + ROWS <= height; i += ROWS) eliminate_rows<S, ROWS>(panel, width, i, width);
    if constexpr (ROWS > 2)
        for (; i + 2 <= height; i += 2) eliminate_rows<S, 2>(panel, width, i, width);
    for (; i < height; ++i) eliminate_rows<S, 1>(panel, width, i, width);
    return good;
}

}  // namespace toile::panel

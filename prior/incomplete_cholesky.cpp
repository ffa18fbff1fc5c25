#include "prior/incomplete_cholesky.h"

#include <algorithm>
#include <type_traits>

#include "prior/float_lanes.h"
#include "prior/lane_vector.h"

namespace toile::prior {
namespace {

/// A symmetric block as (xx, yx, yy, zx, zy, zz).
template <int W>
struct SymmetricBlock {
    Lane<W> xx, yx, yy, zx, zy, zz;
};

template <int W>
[[gnu::always_inline]] inline SymmetricBlock<W> load_block(const double* p) {
    return {load_lanes<W>(p),         load_lanes<W>(p + W),     load_lanes<W>(p + 2 * W),
            load_lanes<W>(p + 3 * W), load_lanes<W>(p + 4 * W), load_lanes<W>(p + 5 * W)};
}
template <int W>
[[gnu::always_inline]] inline LaneVector<W> times(const SymmetricBlock<W>& b, const LaneVector<W>& v) {
    return {b.xx * v.x + b.yx * v.y + b.zx * v.z, b.yx * v.x + b.yy * v.y + b.zy * v.z,
            b.zx * v.x + b.zy * v.y + b.zz * v.z};
}

/// Writes the inverse of `b`; false (in the mask) where b is not positive definite, as compared with the diagonal of
/// `measure`. Such a lane's inverse is left to the caller.
template <int W>
[[gnu::always_inline]] inline LaneMask<W> invert(const SymmetricBlock<W>& b, const SymmetricBlock<W>& measure,
                                                 SymmetricBlock<W>& inverse) {
    constexpr double least = 1e-13;
    const Lane<W> minor = b.xx * b.yy - b.yx * b.yx;
    const Lane<W> c_xx = b.yy * b.zz - b.zy * b.zy, c_yx = b.zx * b.zy - b.yx * b.zz, c_zx = b.yx * b.zy - b.zx * b.yy;
    const Lane<W> determinant = b.xx * c_xx + b.yx * c_yx + b.zx * c_zx;
    const Lane<W> plane = measure.xx * measure.yy;
    const LaneMask<W> good = lane_less(measure.xx * least, b.xx) & lane_less(plane * least, minor) &
                             lane_less(plane * measure.zz * least, determinant) & lane_is_finite(determinant);
    const Lane<W> f = 1.0 / lane_select(good, determinant, lane_broadcast<W>(1.0));
    inverse = {f * c_xx, f * c_yx, f * (b.xx * b.zz - b.zx * b.zx), f * c_zx, f * (b.yx * b.zx - b.xx * b.zy),
               f * minor};
    return good;
}

template <int W>
[[gnu::always_inline]] inline SymmetricBlock<W> choose(const LaneMask<W>& mask, const SymmetricBlock<W>& a,
                                                       const SymmetricBlock<W>& b) {
    return {lane_select(mask, a.xx, b.xx), lane_select(mask, a.yx, b.yx), lane_select(mask, a.yy, b.yy),
            lane_select(mask, a.zx, b.zx), lane_select(mask, a.zy, b.zy), lane_select(mask, a.zz, b.zz)};
}

/// The inverse pivot: of `pivot`, or of the matrix' own block where that is not positive definite, or of its diagonal.
template <int W>
[[gnu::always_inline]] inline LaneMask<W> invert_pivot(const SymmetricBlock<W>& pivot, const SymmetricBlock<W>& own,
                                                       SymmetricBlock<W>& inverse) {
    const LaneMask<W> good = invert<W>(pivot, own, inverse);
    constexpr unsigned all = (1u << W) - 1u;
    if (lane_bits(good) == all) return good;
    const Lane<W> zero = lane_broadcast<W>(0.0), one = lane_broadcast<W>(1.0);
    const Lane<W> trace = lane_abs(own.xx) + lane_abs(own.yy) + lane_abs(own.zz);
    const Lane<W> scale = one / lane_select(lane_less(zero, trace) & lane_is_finite(trace), trace, one);
    SymmetricBlock<W> own_inverse;
    const LaneMask<W> own_good = invert<W>(own, own, own_inverse);
    own_inverse = choose<W>(own_good, own_inverse, {scale, zero, scale, zero, zero, scale});
    inverse = choose<W>(good, inverse, own_inverse);
    return good;
}

template <int W>
[[gnu::always_inline]] inline LaneVector<W> load_form(const double* form, int s, Lane<W>& across) {
    across = load_lanes<W>(form + 4 * W * s + 3 * W);
    return load_vector<W>(form + 4 * W * s);
}
template <int W>
[[gnu::always_inline]] inline LaneVector<W> load_form(const SingleLanes<W>* form, int s, Lane<W>& across) {
    const FloatVector<W> m = load_float_vector<W>(form + 4 * s);
    across = widen<W>(load_floats<W>(form + 4 * s + 3));
    return {widen<W>(m.x), widen<W>(m.y), widen<W>(m.z)};
}

/// The springs of a row lie apart, too far for the processor to guess: asks for one ahead of time.
template <int W, class Number>
[[gnu::always_inline]] inline void fetch_form(const SpringGraph& graph, const Number* form, size_t e) {
    if (e >= graph.entry.size()) return;
    constexpr size_t size = std::is_same_v<Number, double> ? 4 * W * sizeof(double) : 4 * sizeof(Number);
    const char* p = reinterpret_cast<const char*>(form) + size * static_cast<size_t>(graph.entry[e].spring);
    for (size_t line = 0; line < size; line += 64) __builtin_prefetch(p + line);
}

template <int W, class Number>
struct FactorTask {
    const SpringGraph& graph;
    const Number* form;
    const double* diagonal;
    const double* exact;
    SingleLanes<W>* lower;
    double* inverse;
    SingleLanes<W>* pivot;
    double* row;
};

/// One entry (i, j) of row i: subtracts the updates of the common columns, keeps L_ij and L_ij D_j⁻¹, and takes L_ij
/// D_j⁻¹ L_ijᵀ off the pivot.
template <int W, class Number>
[[gnu::always_inline]] inline void factor_entry(const FactorTask<W, Number>& task, int e, int update_begin,
                                                double* scaled, const LaneMask<W>& keep_exact,
                                                SymmetricBlock<W>& pivot) {
    const SpringGraph::Entry& one = task.graph.entry[e];
    Lane<W> across;
    const LaneVector<W> n = load_form<W>(task.form, one.spring, across);
    const double axial = task.graph.spring[one.spring].axial;
    across -= axial;
    const Lane<W> t = lane_select(keep_exact, across, lane_max(across, lane_broadcast<W>(0.0))) + axial;
    LaneVector<W> b[3] = {{-t - n.x * n.x, -n.x * n.y, -n.x * n.z},
                          {-n.y * n.x, -t - n.y * n.y, -n.y * n.z},
                          {-n.z * n.x, -n.z * n.y, -t - n.z * n.z}};
    for (int u = update_begin; u < one.update_end; ++u) {
        const double* left = task.row + 9 * W * task.graph.update[u].left;
        const FloatBlock<W> right = unpack_block<W>(task.lower + packed_size<W> * task.graph.update[u].right);
        LaneVector<W> l[3], r[3];
        for (int k = 0; k < 3; ++k) {
            l[k] = load_vector<W>(left + 3 * W * k);
            r[k] = {widen<W>(right.entry[3 * k]), widen<W>(right.entry[3 * k + 1]), widen<W>(right.entry[3 * k + 2])};
        }
        for (int k = 0; k < 3; ++k)
            b[k] = {b[k].x - dot<W>(l[k], r[0]), b[k].y - dot<W>(l[k], r[1]), b[k].z - dot<W>(l[k], r[2])};
    }
    const SymmetricBlock<W> d = load_block<W>(task.inverse + 6 * W * one.column);
    LaneVector<W> s[3];
    FloatBlock<W> lower;
    for (int k = 0; k < 3; ++k) {
        lower.entry[3 * k] = narrow<W>(b[k].x);
        lower.entry[3 * k + 1] = narrow<W>(b[k].y);
        lower.entry[3 * k + 2] = narrow<W>(b[k].z);
        s[k] = times<W>(d, b[k]);
        store_vector<W>(scaled + 3 * W * k, s[k]);
    }
    pack_block<W>(task.lower + packed_size<W> * e, lower);
    pivot.xx -= dot<W>(s[0], b[0]);
    pivot.yx -= dot<W>(s[1], b[0]);
    pivot.yy -= dot<W>(s[1], b[1]);
    pivot.zx -= dot<W>(s[2], b[0]);
    pivot.zy -= dot<W>(s[2], b[1]);
    pivot.zz -= dot<W>(s[2], b[2]);
}

template <int W, class Number>
TOILE_LANE_KERNEL void factor_rows(const FactorTask<W, Number>& task, double* lost_pivot) {
    const Lane<W> zero = lane_broadcast<W>(0.0), one = lane_broadcast<W>(1.0);
    const LaneMask<W> keep_exact = lane_less(zero, load_lanes<W>(task.exact));
    Lane<W> lost = zero;
    int update = 0;
    for (int i = 0; i < task.graph.vertex_count; ++i) {
        const SymmetricBlock<W> own = load_block<W>(task.diagonal + 6 * W * i);
        SymmetricBlock<W> pivot = own, inverse;
        double* scaled = task.row;
        for (int e = task.graph.row_first[i]; e < task.graph.row_first[i + 1]; ++e, scaled += 9 * W) {
            fetch_form<W>(task.graph, task.form, static_cast<size_t>(e) + 16);
            factor_entry<W, Number>(task, e, update, scaled, keep_exact, pivot);
            update = task.graph.entry[e].update_end;
        }
        lost += lane_select(invert_pivot<W>(pivot, own, inverse), zero, one);
        double* out = task.inverse + 6 * W * i;
        const Lane<W> entries[6] = {inverse.xx, inverse.yx, inverse.yy, inverse.zx, inverse.zy, inverse.zz};
        for (int k = 0; k < 6; ++k) {
            store_lanes<W>(out + W * k, entries[k]);
            store_floats<W>(task.pivot + 6 * i + k, narrow<W>(entries[k]));
        }
    }
    store_lanes<W>(lost_pivot, lost);
}

template <int W>
[[gnu::always_inline]] inline FloatVector<W> load_right_side(const double* r, int i) {
    const LaneVector<W> v = load_vector<W>(r + 3 * W * i);
    return {narrow<W>(v.x), narrow<W>(v.y), narrow<W>(v.z)};
}
template <int W>
[[gnu::always_inline]] inline FloatVector<W> load_right_side(const SingleLanes<W>* r, int i) {
    return load_float_vector<W>(r + 3 * i);
}
/// Keeps z_i; gives r_i · z_i.
template <int W>
[[gnu::always_inline]] inline Lane<W> store_solution(const double* r, double* z, int i, const FloatVector<W>& x) {
    const LaneVector<W> wide{widen<W>(x.x), widen<W>(x.y), widen<W>(x.z)};
    store_vector<W>(z + 3 * W * i, wide);
    return dot<W>(wide, load_vector<W>(r + 3 * W * i));
}
template <int W>
[[gnu::always_inline]] inline Lane<W> store_solution(const SingleLanes<W>* r, SingleLanes<W>* z, int i,
                                                     const FloatVector<W>& x) {
    store_float_vector<W>(z + 3 * i, x);
    return widen<W>(dot<W>(x, load_float_vector<W>(r + 3 * i)));
}

template <int W, class Vector>
TOILE_LANE_KERNEL void solve_forward(const SpringGraph& graph, const SingleLanes<W>* lower, const SingleLanes<W>* pivot,
                                     const Vector* r, SingleLanes<W>* w, SingleLanes<W>* u) {
    const SpringGraph::Entry* entry = graph.entry.data();
    for (int i = 0; i < graph.vertex_count; ++i) {
        FloatVector<W> s = load_right_side<W>(r, i);
        for (int e = graph.row_first[i]; e < graph.row_first[i + 1]; ++e) {
            const FloatVector<W> y = load_float_vector<W>(w + 3 * entry[e].column);
            const FloatBlock<W> l = unpack_block<W>(lower + packed_size<W> * e);
            s.x -= l.entry[0] * y.x + l.entry[1] * y.y + l.entry[2] * y.z;
            s.y -= l.entry[3] * y.x + l.entry[4] * y.y + l.entry[5] * y.z;
            s.z -= l.entry[6] * y.x + l.entry[7] * y.y + l.entry[8] * y.z;
        }
        store_float_vector<W>(u + 3 * i, s);
        store_float_vector<W>(w + 3 * i, pivot_times<W>(pivot + 6 * i, s));
    }
}

template <int W, class Vector>
TOILE_LANE_KERNEL void solve_backward(const SpringGraph& graph, const SingleLanes<W>* lower,
                                      const SingleLanes<W>* pivot, const Vector* r, Vector* z, SingleLanes<W>* u,
                                      double* r_dot_z) {
    const SpringGraph::Entry* entry = graph.entry.data();
    Lane<W> sum = lane_broadcast<W>(0.0);
    for (int i = graph.vertex_count - 1; i >= 0; --i) {
        const FloatVector<W> x = pivot_times<W>(pivot + 6 * i, load_float_vector<W>(u + 3 * i));
        sum += store_solution<W>(r, z, i, x);
        for (int e = graph.row_first[i + 1] - 1; e >= graph.row_first[i]; --e) {
            SingleLanes<W>* out = u + 3 * entry[e].column;
            const FloatBlock<W> l = unpack_block<W>(lower + packed_size<W> * e);
            FloatVector<W> s = load_float_vector<W>(out);
            s.x -= l.entry[0] * x.x + l.entry[3] * x.y + l.entry[6] * x.z;
            s.y -= l.entry[1] * x.x + l.entry[4] * x.y + l.entry[7] * x.z;
            s.z -= l.entry[2] * x.x + l.entry[5] * x.y + l.entry[8] * x.z;
            store_float_vector<W>(out, s);
        }
    }
    store_lanes<W>(r_dot_z, sum);
}

}  // namespace

template <int W>
IncompleteCholesky<W>::IncompleteCholesky(const SpringGraph& graph)
    : graph_(graph),
      lower_(packed_size<W> * graph.spring.size()),
      inverse_(6 * W * static_cast<size_t>(graph.vertex_count)),
      pivot_(6 * static_cast<size_t>(graph.vertex_count)),
      row_(9 * W * static_cast<size_t>(std::max(graph.widest_row, 1))),
      w_(3 * static_cast<size_t>(graph.vertex_count)),
      u_(3 * static_cast<size_t>(graph.vertex_count)) {}

template <int W>
void IncompleteCholesky<W>::factor(const double* form, const double* diagonal, const double* exact,
                                   double* lost_pivot) {
    factor_rows<W, double>({graph_, form, diagonal, exact, lower_.data(), inverse_.data(), pivot_.data(), row_.data()},
                           lost_pivot);
}

template <int W>
void IncompleteCholesky<W>::factor_single(const SingleLanes<W>* form, const double* diagonal, const double* exact,
                                          double* lost_pivot) {
    factor_rows<W, SingleLanes<W>>(
        {graph_, form, diagonal, exact, lower_.data(), inverse_.data(), pivot_.data(), row_.data()}, lost_pivot);
}

template <int W>
void IncompleteCholesky<W>::solve(const double* r, double* z, double* r_dot_z) {
    solve_forward<W>(graph_, lower_.data(), pivot_.data(), r, w_.data(), u_.data());
    solve_backward<W>(graph_, lower_.data(), pivot_.data(), r, z, u_.data(), r_dot_z);
}

template <int W>
void IncompleteCholesky<W>::solve_single(const SingleLanes<W>* r, SingleLanes<W>* z, double* r_dot_z) {
    solve_forward<W>(graph_, lower_.data(), pivot_.data(), r, w_.data(), u_.data());
    solve_backward<W>(graph_, lower_.data(), pivot_.data(), r, z, u_.data(), r_dot_z);
}

template class IncompleteCholesky<1>;
template class IncompleteCholesky<8>;

}  // namespace toile::prior

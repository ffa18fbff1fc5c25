#include "prior/vector_lanes.h"

#include "cloth/lane.h"

namespace toile::prior {

template <int W>
TOILE_LANE_KERNEL void dot_lanes(int size, const double* x, const double* y, double* sum) {
    Lane<W> total = lane_broadcast<W>(0.0);
    for (int i = 0; i < size; ++i) total += load_lanes<W>(x + W * i) * load_lanes<W>(y + W * i);
    store_lanes<W>(sum, total);
}

template <int W>
TOILE_LANE_KERNEL void largest_in_lanes(int size, const double* x, double* result) {
    Lane<W> most = lane_broadcast<W>(0.0);
    for (int i = 0; i < size; ++i) most = lane_max(most, lane_abs(load_lanes<W>(x + W * i)));
    store_lanes<W>(result, most);
}

template <int W>
TOILE_LANE_KERNEL void scale_lanes(int size, const double* a, double* x) {
    const Lane<W> factor = load_lanes<W>(a);
    for (int i = 0; i < size; ++i) store_lanes<W>(x + W * i, factor * load_lanes<W>(x + W * i));
}

template <int W>
TOILE_LANE_KERNEL void subtract_lanes(int size, const double* x, const double* y, double* z) {
    for (int i = 0; i < size; ++i) store_lanes<W>(z + W * i, load_lanes<W>(x + W * i) - load_lanes<W>(y + W * i));
}

template <int W>
TOILE_LANE_KERNEL void add_lanes(int size, const double* a, const double* x, double* y) {
    const Lane<W> zero = lane_broadcast<W>(0.0), factor = load_lanes<W>(a);
    const LaneMask<W> used = lane_less(zero, lane_abs(factor));
    for (int i = 0; i < size; ++i) {
        const Lane<W> change = lane_select(used, factor * load_lanes<W>(x + W * i), zero);
        store_lanes<W>(y + W * i, load_lanes<W>(y + W * i) + change);
    }
}

template <int W>
TOILE_LANE_KERNEL void advance_lanes(int size, const double* a, const double* p, const double* y, double* x, double* r,
                                     double* r_squared, double* r_largest) {
    const Lane<W> length = load_lanes<W>(a);
    Lane<W> sum = lane_broadcast<W>(0.0), most = sum;
    for (int i = 0; i < size; ++i) {
        store_lanes<W>(x + W * i, load_lanes<W>(x + W * i) + length * load_lanes<W>(p + W * i));
        const Lane<W> rest = load_lanes<W>(r + W * i) - length * load_lanes<W>(y + W * i);
        store_lanes<W>(r + W * i, rest);
        sum += rest * rest;
        most = lane_max(most, lane_abs(rest));
    }
    store_lanes<W>(r_squared, sum);
    store_lanes<W>(r_largest, most);
}

template <int W>
TOILE_LANE_KERNEL void turn_lanes(int size, const double* b, const double* z, double* q) {
    const Lane<W> factor = load_lanes<W>(b);
    for (int i = 0; i < size; ++i)
        store_lanes<W>(q + W * i, load_lanes<W>(z + W * i) + factor * load_lanes<W>(q + W * i));
}

template <int W>
TOILE_LANE_KERNEL void step_lanes(int size, const double* s, const double* x, const double* d, const double* g,
                                  const double* origin, double* trial, double* g_dot_d) {
    const Lane<W> length = load_lanes<W>(s);
    const Lane<W> zero = lane_broadcast<W>(0.0);
    const LaneMask<W> moves = lane_less(zero, length);
    Lane<W> sum = zero;
    for (int i = 0; i < size; i += 3) {
        for (int c = 0; c < 3; ++c) {
            const int at = W * (i + c);
            const Lane<W> direction = load_lanes<W>(d + at), shift = load_lanes<W>(origin + W * c);
            const Lane<W> change = lane_select(moves, length * direction, zero);
            const Lane<W> stored = (load_lanes<W>(x + at) - change) + shift;
            store_lanes<W>(trial + at, stored - shift);
            sum += direction * load_lanes<W>(g + at);
        }
    }
    store_lanes<W>(g_dot_d, sum);
}

#define TOILE_INSTANTIATE(W)                                                                                    \
    template void dot_lanes<W>(int, const double*, const double*, double*);                                     \
    template void largest_in_lanes<W>(int, const double*, double*);                                             \
    template void scale_lanes<W>(int, const double*, double*);                                                  \
    template void subtract_lanes<W>(int, const double*, const double*, double*);                                \
    template void add_lanes<W>(int, const double*, const double*, double*);                                     \
    template void advance_lanes<W>(int, const double*, const double*, const double*, double*, double*, double*, \
                                   double*);                                                                    \
    template void turn_lanes<W>(int, const double*, const double*, double*);                                    \
    template void step_lanes<W>(int, const double*, const double*, const double*, const double*, const double*, \
                                double*, double*);
TOILE_INSTANTIATE(1)
TOILE_INSTANTIATE(8)
#undef TOILE_INSTANTIATE

}  // namespace toile::prior

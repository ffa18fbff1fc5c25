#pragma once

#include "cloth/lane.h"

namespace toile::prior {

/// A vector in space in each lane. For kernels only: everything is inlined.
template <int W>
struct LaneVector {
    Lane<W> x, y, z;
};
template <int W>
[[gnu::always_inline]] inline LaneVector<W> load_vector(const double* p) {
    return {load_lanes<W>(p), load_lanes<W>(p + W), load_lanes<W>(p + 2 * W)};
}
template <int W>
[[gnu::always_inline]] inline void store_vector(double* p, const LaneVector<W>& v) {
    store_lanes<W>(p, v.x);
    store_lanes<W>(p + W, v.y);
    store_lanes<W>(p + 2 * W, v.z);
}
template <int W>
[[gnu::always_inline]] inline Lane<W> dot(const LaneVector<W>& a, const LaneVector<W>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int W>
[[gnu::always_inline]] inline LaneVector<W> difference(const double* p, const double* q) {
    return {load_lanes<W>(p) - load_lanes<W>(q), load_lanes<W>(p + W) - load_lanes<W>(q + W),
            load_lanes<W>(p + 2 * W) - load_lanes<W>(q + 2 * W)};
}
/// p += f v, q −= f v.
template <int W>
[[gnu::always_inline]] inline void add_opposite(double* p, double* q, const Lane<W>& f, const LaneVector<W>& v) {
    const Lane<W> x = f * v.x, y = f * v.y, z = f * v.z;
    store_lanes<W>(p, load_lanes<W>(p) + x);
    store_lanes<W>(p + W, load_lanes<W>(p + W) + y);
    store_lanes<W>(p + 2 * W, load_lanes<W>(p + 2 * W) + z);
    store_lanes<W>(q, load_lanes<W>(q) - x);
    store_lanes<W>(q + W, load_lanes<W>(q + W) - y);
    store_lanes<W>(q + 2 * W, load_lanes<W>(q + 2 * W) - z);
}
template <int W>
[[gnu::always_inline]] inline Lane<W> largest_of(const Lane<W>& m, const LaneVector<W>& v) {
    return lane_max(lane_max(m, lane_abs(v.x)), lane_max(lane_abs(v.y), lane_abs(v.z)));
}

/// Adds the symmetric block t I + (a − t) n nᵀ of an edge, a along it and t across, to the diagonal blocks of its two
/// vertices (lower triangles) and writes its negative to its own block. Blocks are `[9][W]`, row-major.
template <int W>
[[gnu::always_inline]] inline void assemble_edge(double* diagonal_a, double* diagonal_b, double* off,
                                                 const Lane<W>& along, const Lane<W>& across, const LaneVector<W>& n) {
    const Lane<W> c = along - across;
    const Lane<W> cx = c * n.x, cy = c * n.y, cz = c * n.z;
    const Lane<W> xx = across + cx * n.x, yx = cy * n.x, yy = across + cy * n.y;
    const Lane<W> zx = cz * n.x, zy = cz * n.y, zz = across + cz * n.z;
    const auto add = [&] [[gnu::always_inline]] (double* d) {
        store_lanes<W>(d, load_lanes<W>(d) + xx);
        store_lanes<W>(d + 3 * W, load_lanes<W>(d + 3 * W) + yx);
        store_lanes<W>(d + 4 * W, load_lanes<W>(d + 4 * W) + yy);
        store_lanes<W>(d + 6 * W, load_lanes<W>(d + 6 * W) + zx);
        store_lanes<W>(d + 7 * W, load_lanes<W>(d + 7 * W) + zy);
        store_lanes<W>(d + 8 * W, load_lanes<W>(d + 8 * W) + zz);
    };
    add(diagonal_a);
    add(diagonal_b);
    store_lanes<W>(off, -xx);
    store_lanes<W>(off + W, -yx);
    store_lanes<W>(off + 2 * W, -zx);
    store_lanes<W>(off + 3 * W, -yx);
    store_lanes<W>(off + 4 * W, -yy);
    store_lanes<W>(off + 5 * W, -zy);
    store_lanes<W>(off + 6 * W, -zx);
    store_lanes<W>(off + 7 * W, -zy);
    store_lanes<W>(off + 8 * W, -zz);
}

}  // namespace toile::prior

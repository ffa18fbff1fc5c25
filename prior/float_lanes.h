#pragma once

#include <cstdint>

#include "cloth/lane.h"

namespace toile::prior {

/// One number of each lane in single precision, as it lies in memory.
template <int W>
struct alignas(4 * W) SingleLanes {
    float lane[W];
};

// What follows is for kernels only: everything is inlined (cloth/lane.h).

using Floats8 = float __attribute__((vector_size(32)));
using StoredFloats8 = float __attribute__((vector_size(32), may_alias));

template <int W>
struct FloatsOf {
    using Type = float;
};
template <>
struct FloatsOf<8> {
    using Type = Floats8;
};
/// Lanes in single precision.
template <int W>
using Floats = typename FloatsOf<W>::Type;

template <int W>
[[gnu::always_inline]] inline Floats<W> load_floats(const SingleLanes<W>* p) {
    if constexpr (W == 1)
        return p->lane[0];
    else
        return *reinterpret_cast<const StoredFloats8*>(p->lane);
}
template <int W>
[[gnu::always_inline]] inline void store_floats(SingleLanes<W>* p, const Floats<W>& x) {
    if constexpr (W == 1)
        p->lane[0] = x;
    else
        *reinterpret_cast<StoredFloats8*>(p->lane) = x;
}
template <int W>
[[gnu::always_inline]] inline Floats<W> narrow(const Lane<W>& x) {
    if constexpr (W == 1)
        return static_cast<float>(x);
    else
        return __builtin_convertvector(x, Floats8);
}
template <int W>
[[gnu::always_inline]] inline Lane<W> widen(const Floats<W>& x) {
    if constexpr (W == 1)
        return x;
    else
        return __builtin_convertvector(x, Lane8);
}

using Words8 = std::uint32_t __attribute__((vector_size(32)));
/// A vector in space in each lane, in single precision.
template <int W>
struct FloatVector {
    Floats<W> x, y, z;
};
template <int W>
[[gnu::always_inline]] inline FloatVector<W> load_float_vector(const SingleLanes<W>* p) {
    return {load_floats<W>(p), load_floats<W>(p + 1), load_floats<W>(p + 2)};
}
template <int W>
[[gnu::always_inline]] inline void store_float_vector(SingleLanes<W>* p, const FloatVector<W>& v) {
    store_floats<W>(p, v.x);
    store_floats<W>(p + 1, v.y);
    store_floats<W>(p + 2, v.z);
}
/// The symmetric block (xx, yx, yy, zx, zy, zz) at p, times v.
template <int W>
[[gnu::always_inline]] inline FloatVector<W> pivot_times(const SingleLanes<W>* p, const FloatVector<W>& v) {
    const Floats<W> xx = load_floats<W>(p), yx = load_floats<W>(p + 1), yy = load_floats<W>(p + 2);
    const Floats<W> zx = load_floats<W>(p + 3), zy = load_floats<W>(p + 4), zz = load_floats<W>(p + 5);
    return {xx * v.x + yx * v.y + zx * v.z, yx * v.x + yy * v.y + zy * v.z, zx * v.x + zy * v.y + zz * v.z};
}
template <int W>
[[gnu::always_inline]] inline Floats<W> dot(const FloatVector<W>& a, const FloatVector<W>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A block of nine numbers, row by row. Of eight lanes it is kept with eight bits of precision, in five words: of all
/// but the last, the upper half of one number and that of the next. Of one lane, which is bound by arithmetic, as it
/// is.
template <int W>
struct FloatBlock {
    Floats<W> entry[9];
};
template <int W>
inline constexpr int packed_size = W == 1 ? 9 : 5;

template <int W>
[[gnu::always_inline]] inline FloatBlock<W> unpack_block(const SingleLanes<W>* p) {
    FloatBlock<W> block;
    if constexpr (W == 1) {
        for (int k = 0; k < 9; ++k) block.entry[k] = load_floats<W>(p + k);
    } else {
        for (int k = 0; k < 5; ++k) {
            const Words8 word = reinterpret_cast<Words8>(load_floats<W>(p + k));
            block.entry[2 * k] = reinterpret_cast<Floats8>(word & 0xffff0000u);
            if (k < 4) block.entry[2 * k + 1] = reinterpret_cast<Floats8>(word << 16);
        }
    }
    return block;
}
/// Rounds to nearest.
template <int W>
[[gnu::always_inline]] inline void pack_block(SingleLanes<W>* p, const FloatBlock<W>& block) {
    if constexpr (W == 1) {
        for (int k = 0; k < 9; ++k) store_floats<W>(p + k, block.entry[k]);
    } else {
        for (int k = 0; k < 5; ++k) {
            Words8 word = (reinterpret_cast<Words8>(block.entry[2 * k]) + 0x8000u) & 0xffff0000u;
            if (k < 4) word |= (reinterpret_cast<Words8>(block.entry[2 * k + 1]) + 0x8000u) >> 16;
            store_floats<W>(p + k, reinterpret_cast<Floats8>(word));
        }
    }
}

}  // namespace toile::prior

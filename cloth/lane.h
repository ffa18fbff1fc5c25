#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

/// Samples side by side in SIMD lanes: the same code runs one sample (W = 1, plain double) or eight (W = 8, one vector
/// register with AVX-512). Written with the compiler's vector extension, so +, -, * and / are operators, also with a
/// double on one side; the rest stands below, overloaded for both. Lanes never mix: a lane's result depends on that
/// lane alone. Do not compare with < or choose with ?: on eight lanes: g++ 12 takes both apart into single numbers
/// where a function is compiled for several instruction sets. `lane_less` and `lane_select` are a few instructions.
///
///     template <int W>
///     [[gnu::always_inline]] inline Lane<W> length(const double* d) {   // d is [3][W]
///         const Lane<W> x = load_lanes<W>(d), y = load_lanes<W>(d + W), z = load_lanes<W>(d + 2 * W);
///         return lane_sqrt(x * x + y * y + z * z);
///     }
///     TOILE_LANE_KERNEL void lengths(int n, const double* d, double* out) {   // a loop over length<8>
///
/// Functions that take or return lanes must be always_inline: passed in registers they would tie caller and callee to
/// one instruction set. Only whole loops over plain pointers become kernels.

/// Compiles a function, with everything inlined into it, for AVX-512, AVX2 and plain x86-64; the processor picks when
/// the program is loaded. Functions it calls and that are not inlined stay plain, so no library code is tied to one
/// set. May be put on non-member functions and static members, also templates that are instantiated in that file.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define TOILE_LANE_KERNEL __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define TOILE_LANE_KERNEL
#endif

namespace toile {

using Lane8 = double __attribute__((vector_size(64)));
using LaneMask8 = long long __attribute__((vector_size(64)));
/// How lanes are read from arrays of double.
using StoredLane8 = double __attribute__((vector_size(64), may_alias));

template <int W>
struct LaneTypes;
template <>
struct LaneTypes<1> {
    using Lane = double;
    using Mask = bool;
};
template <>
struct LaneTypes<8> {
    using Lane = Lane8;
    using Mask = LaneMask8;
};

template <int W>
using Lane = typename LaneTypes<W>::Lane;
/// What a comparison of lanes gives; combine with &, | and pass to `lane_select` or `lane_bits`.
template <int W>
using LaneMask = typename LaneTypes<W>::Mask;

/// Bytes that `load_lanes` wants arrays of `[...][W]` doubles aligned to.
template <int W>
inline constexpr int lane_alignment = W * 8;

template <int W>
[[gnu::always_inline]] inline Lane<W> load_lanes(const double* p) {
    if constexpr (W == 1) {
        return *p;
    } else {
        return *reinterpret_cast<const StoredLane8*>(p);
    }
}
template <int W>
[[gnu::always_inline]] inline void store_lanes(double* p, Lane<W> x) {
    if constexpr (W == 1) {
        *p = x;
    } else {
        *reinterpret_cast<StoredLane8*>(p) = x;
    }
}

/// x in all lanes (-0 as 0). As a factor or summand x itself does, without this.
template <int W>
[[gnu::always_inline]] inline Lane<W> lane_broadcast(double x) {
    if constexpr (W == 1)
        return x;
    else
        return Lane8{} + x;  // two instructions; a list of eight x would be put together one by one
}

[[gnu::always_inline]] inline double lane_get(double x, int) {
    return x;
}
[[gnu::always_inline]] inline double lane_get(Lane8 x, int lane) {
    return x[lane];
}

/// a < b. Without meaning where one of them is NaN or both are the same infinity; -0 may count as less than 0.
[[gnu::always_inline]] inline bool lane_less(double a, double b) {
    return a < b;
}
[[gnu::always_inline]] inline LaneMask8 lane_less(Lane8 a, Lane8 b) {
    return reinterpret_cast<LaneMask8>(a - b) >> 63;
}
/// Neither NaN nor infinite.
[[gnu::always_inline]] inline bool lane_is_finite(double x) {
    return __builtin_isfinite(x);
}
[[gnu::always_inline]] inline LaneMask8 lane_is_finite(Lane8 x) {
    constexpr long long exponent = 0x7ff0000000000000;
    return ((reinterpret_cast<LaneMask8>(x) & exponent) - exponent) >> 63;
}

/// a where the mask holds, else b.
[[gnu::always_inline]] inline double lane_select(bool mask, double a, double b) {
    return mask ? a : b;
}
[[gnu::always_inline]] inline Lane8 lane_select(LaneMask8 mask, Lane8 a, Lane8 b) {
    return reinterpret_cast<Lane8>((mask & reinterpret_cast<LaneMask8>(a)) | (~mask & reinterpret_cast<LaneMask8>(b)));
}

/// Bit l tells of lane l.
[[gnu::always_inline]] inline unsigned lane_bits(bool mask) {
    return mask ? 1u : 0u;
}
[[gnu::always_inline]] inline unsigned lane_bits(LaneMask8 mask) {
    mask &= LaneMask8{1, 2, 4, 8, 16, 32, 64, 128};
    return static_cast<unsigned>((mask[0] | mask[1] | mask[2] | mask[3]) | (mask[4] | mask[5] | mask[6] | mask[7]));
}

[[gnu::always_inline]] inline double lane_min(double a, double b) {
    return a < b ? a : b;
}
[[gnu::always_inline]] inline Lane8 lane_min(Lane8 a, Lane8 b) {
    return lane_select(lane_less(a, b), a, b);
}
[[gnu::always_inline]] inline double lane_max(double a, double b) {
    return b < a ? a : b;
}
[[gnu::always_inline]] inline Lane8 lane_max(Lane8 a, Lane8 b) {
    return lane_select(lane_less(b, a), a, b);
}
[[gnu::always_inline]] inline double lane_abs(double x) {
    return __builtin_fabs(x);
}
[[gnu::always_inline]] inline Lane8 lane_abs(Lane8 x) {
    return reinterpret_cast<Lane8>(reinterpret_cast<LaneMask8>(x) & 0x7fffffffffffffff);
}

/// NaN for negative lanes; errno stays as it is.
[[gnu::always_inline]] inline double lane_sqrt(double x) {
#if defined(__SSE2__)
    return _mm_cvtsd_f64(_mm_sqrt_pd(_mm_set1_pd(x)));
#else
    return __builtin_sqrt(x);
#endif
}
[[gnu::always_inline]] inline Lane8 lane_sqrt(Lane8 x) {
#if defined(__SSE2__)
    // Two at a time, the one width that every x86-64 has an instruction for.
    const __m128d a = _mm_sqrt_pd(__builtin_shufflevector(x, x, 0, 1));
    const __m128d b = _mm_sqrt_pd(__builtin_shufflevector(x, x, 2, 3));
    const __m128d c = _mm_sqrt_pd(__builtin_shufflevector(x, x, 4, 5));
    const __m128d d = _mm_sqrt_pd(__builtin_shufflevector(x, x, 6, 7));
    return __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 1, 2, 3), __builtin_shufflevector(c, d, 0, 1, 2, 3),
                                   0, 1, 2, 3, 4, 5, 6, 7);
#else
    for (int l = 0; l < 8; ++l) x[l] = __builtin_sqrt(x[l]);
    return x;
#endif
}

}  // namespace toile

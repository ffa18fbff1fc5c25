#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "cloth/lane.h"

namespace toile::simulate {

constexpr int xpbd_lanes = 8;

/// Up to eight stencils of N vertices, no two of which share one: a Gauss-Seidel sweep takes them side by side in SIMD
/// lanes as if one after another. Lanes from `count` on repeat the first.
template <int N>
struct XpbdBatch {
    int vertex[N][xpbd_lanes];
    int item[xpbd_lanes];  ///< index of the stencil
    int count = 0;
};

/// All stencils, each into the first of the latest batches that has room for it. A sweep's order is that of the
/// batches.
template <int N>
std::vector<XpbdBatch<N>> make_batches(const std::vector<std::array<int, N>>& stencils) {
    constexpr size_t window = 64;
    std::vector<XpbdBatch<N>> batches;
    const auto fits = [](const XpbdBatch<N>& batch, const std::array<int, N>& stencil) {
        if (batch.count == xpbd_lanes) return false;
        for (int i = 0; i < N; ++i)
            for (int lane = 0; lane < batch.count; ++lane)
                if (std::find(stencil.begin(), stencil.end(), batch.vertex[i][lane]) != stencil.end()) return false;
        return true;
    };
    for (size_t k = 0; k < stencils.size(); ++k) {
        size_t b = batches.size() > window ? batches.size() - window : 0;
        while (b < batches.size() && !fits(batches[b], stencils[k])) ++b;
        if (b == batches.size()) batches.emplace_back();
        XpbdBatch<N>& batch = batches[b];
        const int first = batch.count++;
        // A new batch begins with this stencil in all lanes.
        for (int lane = first; lane < (first == 0 ? xpbd_lanes : first + 1); ++lane) {
            for (int i = 0; i < N; ++i) batch.vertex[i][lane] = stencils[k][i];
            batch.item[lane] = static_cast<int>(k);
        }
    }
    return batches;
}

/// Entry `component` of the rows `index` of an array `[... x stride]`.
[[gnu::always_inline]] inline Lane8 gather_lanes(const double* rows, int stride, const int* index, int component) {
    alignas(64) double value[xpbd_lanes];
    for (int lane = 0; lane < xpbd_lanes; ++lane) value[lane] = rows[stride * index[lane] + component];
    return load_lanes<8>(value);
}
[[gnu::always_inline]] inline void scatter_lanes(Lane8 values, double* rows, int stride, const int* index,
                                                 int component, int count) {
    alignas(64) double value[xpbd_lanes];
    store_lanes<8>(value, values);
    for (int lane = 0; lane < count; ++lane) rows[stride * index[lane] + component] = value[lane];
}
[[gnu::always_inline]] inline void scatter_add_lanes(Lane8 values, double* rows, int stride, const int* index,
                                                     int component, int count) {
    alignas(64) double value[xpbd_lanes];
    store_lanes<8>(value, values);
    for (int lane = 0; lane < count; ++lane) rows[stride * index[lane] + component] += value[lane];
}

}  // namespace toile::simulate

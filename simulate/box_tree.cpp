#include "simulate/box_tree.h"

#include <algorithm>
#include <bit>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>
#include <limits>

namespace toile::simulate {
namespace {

constexpr int most_curve_bits = 21;  // per axis: 3 * 21 fit 64 bits

// Two zeros after each of the lowest 21 bits.
std::uint64_t spread_bits(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffffull;
    bits = (bits | bits << 16) & 0x001f0000ff0000ffull;
    bits = (bits | bits << 8) & 0x100f00f00f00f00full;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
    return (bits | bits << 2) & 0x1249249249249249ull;
}

}  // namespace

Box Box::empty() {
    Box box;
    box.low.fill(std::numeric_limits<float>::infinity());
    box.high.fill(-std::numeric_limits<float>::infinity());
    return box;
}

void Box::widen(float margin) {
    constexpr float rounding = 4.0f * std::numeric_limits<float>::epsilon();
    constexpr float least = std::numeric_limits<float>::min();
    if (!(low[0] <= high[0])) return;  // empty
    for (int k = 0; k < 3; ++k) {
        low[k] -= margin + rounding * (std::abs(low[k]) + margin) + least;
        high[k] += margin + rounding * (std::abs(high[k]) + margin) + least;
    }
}

void EightBoxes::set(int slot, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        low[k][slot] = box.low[k];
        high[k][slot] = box.high[k];
    }
}

void BoxTree::sort(const std::vector<Box>& box, float reach) {
    // As many bits for the place on the curve as the index leaves.
    const int index_bits = std::bit_width(box.size()), curve_bits = std::min(most_curve_bits, (64 - index_bits) / 3);
    const double cells = static_cast<double>((1u << curve_bits) - 1), scale = reach > 0.0f ? 0.25 * cells / reach : 0.0;
    key_.resize(box.size());
    for (std::size_t i = 0; i < box.size(); ++i) {
        std::uint64_t curve = 0;
        for (int k = 0; k < 3; ++k) {
            // From [-2 reach, 2 reach] to all cells; written so that what is not a number becomes 0.
            const double cell = 0.5 * cells + scale * (static_cast<double>(box[i].low[k]) + box[i].high[k]);
            curve |= spread_bits(static_cast<std::uint64_t>(cell > 0.0 ? std::min(cell, cells) : 0.0)) << k;
        }
        key_[i] = curve << index_bits | i;
    }
    boost::sort::spreadsort::integer_sort(key_.begin(), key_.end());
    order_.resize(box.size());
    const std::uint64_t index_mask = (std::uint64_t{1} << index_bits) - 1;
    for (std::size_t i = 0; i < box.size(); ++i) order_[i] = static_cast<int>(key_[i] & index_mask);
}

void BoxTree::build(const std::vector<Box>& box, float reach) {
    sort(box, reach);
    level_box_.resize(1);
    level_box_[0].resize(box.size());
    for (std::size_t i = 0; i < box.size(); ++i) level_box_[0][i] = box[order_[i]];
    level_.clear();
    do {
        const std::vector<Box>& below = level_box_.back();
        std::vector<EightBoxes> level((below.size() + 7) / 8);
        std::vector<Box> above(level.size(), Box::empty());
        for (std::size_t i = 0; i < 8 * level.size(); ++i) {
            const Box child = i < below.size() ? below[i] : Box::empty();
            level[i / 8].set(static_cast<int>(i % 8), child);
            above[i / 8] = around(above[i / 8], child);
        }
        level_.push_back(std::move(level));
        level_box_.push_back(std::move(above));
    } while (level_box_.back().size() > 1);
}

}  // namespace toile::simulate

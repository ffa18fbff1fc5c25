#include "simulate/box_tree.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <limits>

namespace toile::simulate {
namespace {

constexpr int curve_bits = 21;  // per axis: 3 * 21 fit 64 bits

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

void EightBoxes::set(int slot, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        low[k][slot] = box.low[k];
        high[k][slot] = box.high[k];
    }
}

Box EightBoxes::box(int slot) const {
    return {{low[0][slot], low[1][slot], low[2][slot], 0.0f}, {high[0][slot], high[1][slot], high[2][slot], 0.0f}};
}

Box EightBoxes::around_all() const {
    Box all = box(0);
    for (int slot = 1; slot < 8; ++slot) all = around(all, box(slot));
    return all;
}

void BoxTree::sort(const std::vector<Box>& box, float extent) {
    const double cells = (1u << curve_bits) - 1, scale = extent > 0.0f ? 0.25 * cells / extent : 0.0;
    order_.resize(box.size());
    for (std::size_t i = 0; i < box.size(); ++i) {
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) {
            // From [-2 extent, 2 extent]; written so that what is not a number becomes 0.
            const double cell = 0.5 * cells + scale * (static_cast<double>(box[i].low[k]) + box[i].high[k]);
            key |= spread_bits(static_cast<std::uint64_t>(cell > 0.0 ? std::min(cell, cells) : 0.0)) << k;
        }
        order_[i] = {key, static_cast<int>(i)};
    }
    boost::sort::spreadsort::integer_sort(
        order_.begin(), order_.end(), [](const Keyed& keyed, unsigned bits) { return keyed.key >> bits; },
        [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
}

void BoxTree::build(const std::vector<Box>& box, float extent) {
    sort(box, extent);
    level_.resize(1);
    level_[0].resize((box.size() + 7) / 8);
    for (std::size_t i = 0; i < 8 * level_[0].size(); ++i)
        level_[0][i / 8].set(static_cast<int>(i % 8), i < box.size() ? box[order_[i].index] : Box::empty());
    while (level_.back().size() > 1) {
        const std::vector<EightBoxes>& below = level_.back();
        std::vector<EightBoxes> level((below.size() + 7) / 8);
        for (std::size_t i = 0; i < 8 * level.size(); ++i)
            level[i / 8].set(static_cast<int>(i % 8), i < below.size() ? below[i].around_all() : Box::empty());
        level_.push_back(std::move(level));
    }
}

}  // namespace toile::simulate

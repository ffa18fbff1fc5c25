#pragma once

#include <array>
#include <cstdint>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace toile::simulate {

/// Axis-aligned box; the fourth number only fills the register.
struct alignas(16) Box {
    std::array<float, 4> low, high;

    /// The smallest box around both.
    friend Box around(const Box& a, const Box& b) {
        Box both;
        for (int k = 0; k < 4; ++k) {
            both.low[k] = b.low[k] < a.low[k] ? b.low[k] : a.low[k];
            both.high[k] = b.high[k] > a.high[k] ? b.high[k] : a.high[k];
        }
        return both;
    }
    /// Overlaps nothing.
    static Box empty();
    /// Moves all sides outwards, by the margin and by what the roundings of this and of the sides themselves can take
    /// away.
    void widen(float margin);
};

/// Eight boxes, coordinate by coordinate, so that one box is tested against all at once.
struct alignas(32) EightBoxes {
    float low[3][8], high[3][8];

    void set(int slot, const Box& box);
    /// Bit k: box k overlaps or touches the other one.
    unsigned overlapping(const Box& other) const;
};

inline unsigned EightBoxes::overlapping(const Box& other) const {
#if defined(__SSE2__)
    // Left to the compiler the eight comparisons become bytes and shifts, at four times the time.
    __m128 left = _mm_castsi128_ps(_mm_set1_epi32(-1)), right = left;
    for (int axis = 0; axis < 3; ++axis) {
        const __m128 other_low = _mm_set1_ps(other.low[axis]), other_high = _mm_set1_ps(other.high[axis]);
        left = _mm_and_ps(left, _mm_and_ps(_mm_cmple_ps(_mm_load_ps(low[axis]), other_high),
                                           _mm_cmpge_ps(_mm_load_ps(high[axis]), other_low)));
        right = _mm_and_ps(right, _mm_and_ps(_mm_cmple_ps(_mm_load_ps(low[axis] + 4), other_high),
                                             _mm_cmpge_ps(_mm_load_ps(high[axis] + 4), other_low)));
    }
    return static_cast<unsigned>(_mm_movemask_ps(left) | _mm_movemask_ps(right) << 4);
#else
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k) {
        bool overlap = true;
        for (int axis = 0; axis < 3; ++axis)
            overlap = overlap & (low[axis][k] <= other.high[axis]) & (high[axis][k] >= other.low[axis]);
        bits |= static_cast<unsigned>(overlap) << k;
    }
    return bits;
#endif
}

/// Bounding volume hierarchy with eight children a node, built anew for each set of boxes: sorted along a Morton curve,
/// then eight by eight, level by level. Large boxes among small ones widen a few nodes, no more.
class BoxTree {
  public:
    /// Most coordinates should be within `reach` of 0; what is further than twice that is sorted less well.
    void build(const std::vector<Box>& box, float reach);

    /// Calls visit(i, j) for every box i of this tree and j of the other that overlap or touch, as long as it returns
    /// true. False where it was stopped.
    template <typename Visit>
    bool each_overlap(const BoxTree& other, Visit&& visit) const;
    /// Calls visit(i, j) once for every two boxes of this tree that overlap or touch, in either order; the same.
    template <typename Visit>
    bool each_overlap(Visit&& visit) const;

  private:
    void sort(const std::vector<Box>& box, float reach);
    int group_count() const { return static_cast<int>(level_box_.empty() ? 0 : level_box_[1].size()); }

    // Calls visit(group) for every lowest group, from `first` on, that overlaps the box.
    template <typename Visit>
    bool each_group(const Box& box, int first, Visit&& visit) const;
    // Calls visit(i, j) for what overlaps of group a of this tree and group b of the other.
    template <bool Same, typename Visit>
    bool each_pair(int a, const BoxTree& other, int b, Visit&& visit) const;

    std::vector<std::uint64_t> key_;
    std::vector<int> order_;                      // index of each sorted box
    std::vector<std::vector<Box>> level_box_;     // 0: sorted; k + 1: around each eight of k
    std::vector<std::vector<EightBoxes>> level_;  // level_box_ once more, eight by eight
};

template <typename Visit>
bool BoxTree::each_group(const Box& box, int first, Visit&& visit) const {
    struct Entry {
        int level, group;
    };
    std::array<Entry, 128> stack;  // at most 7 wait on each of at most 11 levels
    int size = 0;
    const auto push = [&](int level, int group) {
        if ((static_cast<std::int64_t>(group + 1) << (3 * level)) > first) stack[size++] = {level, group};
    };
    push(static_cast<int>(level_.size()) - 1, 0);
    while (size > 0) {
        const Entry entry = stack[--size];
        if (entry.level == 0) {
            if (!visit(entry.group)) return false;
            continue;
        }
        for (unsigned bits = level_[entry.level][entry.group].overlapping(box); bits != 0; bits &= bits - 1)
            push(entry.level - 1, 8 * entry.group + __builtin_ctz(bits));
    }
    return true;
}

template <bool Same, typename Visit>
bool BoxTree::each_pair(int a, const BoxTree& other, int b, Visit&& visit) const {
    const EightBoxes& mine = level_[0][a];
    const EightBoxes& theirs = other.level_[0][b];
    for (unsigned rows = mine.overlapping(other.level_box_[1][b]); rows != 0; rows &= rows - 1) {
        const int i = __builtin_ctz(rows);
        unsigned columns = theirs.overlapping(level_box_[0][8 * a + i]);
        if (Same && a == b) columns &= ~0u << (i + 1);
        for (; columns != 0; columns &= columns - 1)
            if (!visit(order_[8 * a + i], other.order_[8 * b + __builtin_ctz(columns)])) return false;
    }
    return true;
}

template <typename Visit>
bool BoxTree::each_overlap(const BoxTree& other, Visit&& visit) const {
    if (other.group_count() == 0) return true;
    for (int a = 0; a < group_count(); ++a) {
        const auto pairs = [&](int b) { return each_pair<false>(a, other, b, visit); };
        if (!other.each_group(level_box_[1][a], 0, pairs)) return false;
    }
    return true;
}

template <typename Visit>
bool BoxTree::each_overlap(Visit&& visit) const {
    for (int a = 0; a < group_count(); ++a) {
        const auto pairs = [&](int b) { return each_pair<true>(a, *this, b, visit); };
        if (!each_group(level_box_[1][a], a, pairs)) return false;
    }
    return true;
}

}  // namespace toile::simulate

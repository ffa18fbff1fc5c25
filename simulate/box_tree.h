#pragma once

#include <array>
#include <cstdint>
#include <vector>

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
};

/// Eight boxes, coordinate by coordinate, so that one box is tested against all at once.
struct alignas(32) EightBoxes {
    float low[3][8], high[3][8];

    void set(int slot, const Box& box);
    Box box(int slot) const;
    Box around_all() const;
    /// Bit k: box k overlaps or touches the other one.
    unsigned overlapping(const Box& other) const {
        unsigned bits = 0;
        for (int k = 0; k < 8; ++k) {
            const bool apart = (low[0][k] > other.high[0]) | (high[0][k] < other.low[0]) | (low[1][k] > other.high[1]) |
                               (high[1][k] < other.low[1]) | (low[2][k] > other.high[2]) | (high[2][k] < other.low[2]);
            bits |= apart ? 0u : 1u << k;
        }
        return bits;
    }
};

/// Bounding volume hierarchy with eight children a node, built anew for each set of boxes: sorted along a Morton curve,
/// then eight by eight, level by level. Large boxes among small ones widen a few nodes, no more.
class BoxTree {
  public:
    /// `extent` bounds all finite coordinates' absolute values.
    void build(const std::vector<Box>& box, float extent);

    /// Calls visit(i, j) for every box i of this tree and j of the other that overlap or touch.
    template <typename Visit>
    void each_overlap(const BoxTree& other, Visit&& visit) const;
    /// Calls visit(i, j) once for every two boxes of this tree that overlap or touch, in either order.
    template <typename Visit>
    void each_overlap(Visit&& visit) const;

  private:
    struct Keyed {
        std::uint64_t key;
        int index;
    };
    void sort(const std::vector<Box>& box, float extent);
    int group_count() const { return static_cast<int>(level_.empty() ? 0 : level_[0].size()); }

    // Calls visit(group) for every lowest group, from `first` on, that overlaps the box.
    template <typename Visit>
    void each_group(const Box& box, int first, Visit&& visit) const;
    // Calls visit(i, j) for what overlaps of group a of this tree and group b of the other.
    template <bool Same, typename Visit>
    void each_pair(int a, const BoxTree& other, int b, Visit&& visit) const;

    std::vector<Keyed> order_;
    std::vector<std::vector<EightBoxes>> level_;  // 0: the boxes themselves; the last: one group
};

template <typename Visit>
void BoxTree::each_group(const Box& box, int first, Visit&& visit) const {
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
            visit(entry.group);
            continue;
        }
        for (unsigned bits = level_[entry.level][entry.group].overlapping(box); bits != 0; bits &= bits - 1)
            push(entry.level - 1, 8 * entry.group + __builtin_ctz(bits));
    }
}

template <bool Same, typename Visit>
void BoxTree::each_pair(int a, const BoxTree& other, int b, Visit&& visit) const {
    const EightBoxes& mine = level_[0][a];
    const EightBoxes& theirs = other.level_[0][b];
    for (unsigned rows = mine.overlapping(theirs.around_all()); rows != 0; rows &= rows - 1) {
        const int i = __builtin_ctz(rows);
        unsigned columns = theirs.overlapping(mine.box(i));
        if (Same && a == b) columns &= ~0u << (i + 1);
        for (; columns != 0; columns &= columns - 1)
            visit(order_[8 * a + i].index, other.order_[8 * b + __builtin_ctz(columns)].index);
    }
}

template <typename Visit>
void BoxTree::each_overlap(const BoxTree& other, Visit&& visit) const {
    if (other.group_count() == 0) return;
    for (int a = 0; a < group_count(); ++a)
        other.each_group(level_[0][a].around_all(), 0, [&](int b) { each_pair<false>(a, other, b, visit); });
}

template <typename Visit>
void BoxTree::each_overlap(Visit&& visit) const {
    for (int a = 0; a < group_count(); ++a)
        each_group(level_[0][a].around_all(), a, [&](int b) { each_pair<true>(a, *this, b, visit); });
}

}  // namespace toile::simulate

#include "cloth/block_symbolic.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "cloth/error.h"
#include "cloth/vertex_ordering.h"

namespace toile {
namespace {

using Lists = std::vector<std::vector<int>>;

/// A node of the supernode tree while it is being shaped. Columns and rows are positions in elimination order.
struct Front {
    std::vector<int> column;  // rising
    std::vector<int> below;   // rows under its columns, rising
    std::vector<int> child;
    int parent = -1;
    bool merged = false;  // its columns now belong to its parent
};

std::vector<std::pair<int, int>> unique_pairs(int vertex_count, std::vector<std::pair<int, int>> pairs) {
    for (auto& [i, j] : pairs) {
        if (i < j) std::swap(i, j);
        if (j < 0 || i >= vertex_count) throw Error("a vertex pair of a block matrix is out of range");
    }
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    std::sort(pairs.begin(), pairs.end(),
              [](const auto& a, const auto& b) { return std::tie(a.second, a.first) < std::tie(b.second, b.first); });
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

/// Parent of each position in the elimination tree (Liu); `earlier[i]` are the neighbours of i before it.
std::vector<int> elimination_tree(const Lists& earlier) {
    const int n = static_cast<int>(earlier.size());
    std::vector<int> parent(n, -1), ancestor(n, -1);
    for (int i = 0; i < n; ++i) {
        for (int k : earlier[i]) {
            while (ancestor[k] != -1 && ancestor[k] != i) {
                const int next = ancestor[k];
                ancestor[k] = i;
                k = next;
            }
            if (ancestor[k] == -1 && k != i) ancestor[k] = parent[k] = i;
        }
    }
    return parent;
}

/// Rows below the diagonal of each column of the factor, rising.
Lists factor_columns(const Lists& later, const std::vector<int>& parent) {
    const int n = static_cast<int>(later.size());
    Lists column = later;
    std::vector<int> mark(n, -1);
    Lists children(n);
    for (int j = 0; j < n; ++j) {
        auto& rows = column[j];
        for (int i : rows) mark[i] = j;
        for (int c : children[j])
            for (int i : column[c])
                if (i != j && mark[i] != j) {
                    mark[i] = j;
                    rows.push_back(i);
                }
        std::sort(rows.begin(), rows.end());
        if (parent[j] >= 0) children[parent[j]].push_back(j);
    }
    return column;
}

/// Columns that share their rows, joined: a column joins its only child if that has no other rows.
std::vector<Front> fundamental_fronts(Lists columns, const std::vector<int>& parent) {
    const int n = static_cast<int>(columns.size());
    std::vector<int> child_count(n, 0), some_child(n, -1), front_of(n, -1);
    for (int j = 0; j < n; ++j) {
        if (parent[j] < 0) continue;
        ++child_count[parent[j]];
        some_child[parent[j]] = j;
    }
    std::vector<Front> fronts;
    for (int j = 0; j < n; ++j) {
        const int child = some_child[j];
        if (child_count[j] == 1 && columns[child].size() == columns[j].size() + 1) {
            front_of[j] = front_of[child];
        } else {
            front_of[j] = static_cast<int>(fronts.size());
            fronts.emplace_back();
        }
        fronts[front_of[j]].column.push_back(j);
    }
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
        const int last = fronts[f].column.back();
        fronts[f].below = std::move(columns[last]);
        if (parent[last] < 0) continue;
        fronts[f].parent = front_of[parent[last]];
        fronts[fronts[f].parent].child.push_back(f);
    }
    return fronts;
}

/// Estimated cycles (eight lanes) of a front with `width` columns and `below` rows under them.
double front_cost(double width, double below) {
    constexpr double product = 13.5;  // of two blocks
    constexpr double tile = 12;       // reading and writing a block that products are subtracted from
    constexpr double memory = 100;    // of one block of the factor
    constexpr double row = 30, front = 500;
    const double tiles = 0.5 * below * (below + 1);
    const double products = width * tiles + 0.5 * width * width * below + width * width * width / 6;
    return product * products + tile * tiles + memory * width * (below + 0.5 * width) + row * below + front;
}

void merge_into_parent(std::vector<Front>& fronts, int child) {
    Front& c = fronts[child];
    Front& p = fronts[c.parent];
    std::vector<int> column;
    std::merge(c.column.begin(), c.column.end(), p.column.begin(), p.column.end(), std::back_inserter(column));
    p.column = std::move(column);
    std::erase(p.child, child);
    for (int grandchild : c.child) {
        fronts[grandchild].parent = c.parent;
        p.child.push_back(grandchild);
    }
    c.merged = true;
}

/// Relaxed amalgamation: a child's columns go to its parent while the zeros this stores cost less than they save.
void amalgamate(std::vector<Front>& fronts) {
    const auto cost = [&](const Front& front, size_t extra) {
        return front_cost(static_cast<double>(front.column.size() + extra), static_cast<double>(front.below.size()));
    };
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
        while (true) {
            const Front& front = fronts[f];
            int best = -1;
            double best_gain = 0;
            for (int c : front.child) {
                const double gain = cost(fronts[c], 0) + cost(front, 0) - cost(front, fronts[c].column.size());
                if (gain > best_gain) best = c, best_gain = gain;
            }
            if (best < 0) break;
            merge_into_parent(fronts, best);
        }
    }
}

/// Fronts that are left, children before parents and the child with most rows next to its parent, where its panel is
/// still in the cache.
std::vector<int> postorder(std::vector<Front>& fronts) {
    const int n = static_cast<int>(fronts.size());
    std::vector<int> order, stack;
    for (int f = n - 1; f >= 0; --f) {
        std::stable_sort(fronts[f].child.begin(), fronts[f].child.end(),
                         [&](int a, int b) { return fronts[a].below.size() < fronts[b].below.size(); });
        if (!fronts[f].merged && fronts[f].parent < 0) stack.push_back(f);
    }
    // Parents first with children reversed, then turned round.
    std::reverse(stack.begin(), stack.end());
    while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        order.push_back(f);
        stack.insert(stack.end(), fronts[f].child.begin(), fronts[f].child.end());
    }
    std::reverse(order.begin(), order.end());
    return order;
}

}  // namespace

BlockSymbolic::BlockSymbolic(int vertex_count, std::vector<std::pair<int, int>> pairs)
    : vertex_count_(vertex_count), pair_(unique_pairs(vertex_count, std::move(pairs))) {
    build(order_vertices(vertex_count_, pair_));
}

BlockSymbolic::BlockSymbolic(const BlockSymbolic& other, std::vector<std::pair<int, int>> pairs)
    : vertex_count_(other.vertex_count_), pair_(unique_pairs(vertex_count_, std::move(pairs))) {
    build(other.vertex_);
}

void BlockSymbolic::build(const std::vector<int>& order) {
    pair_start_.assign(vertex_count_ + 1, 0);
    for (const auto& pair : pair_) ++pair_start_[pair.second + 1];
    std::partial_sum(pair_start_.begin(), pair_start_.end(), pair_start_.begin());
    find_supernodes(order);
    list_entries();
    list_updates();
}

void BlockSymbolic::find_supernodes(const std::vector<int>& order) {
    std::vector<int> position(vertex_count_);
    for (int k = 0; k < vertex_count_; ++k) position[order[k]] = k;
    Lists earlier(vertex_count_), later(vertex_count_);
    for (const auto& [i, j] : pair_) {
        const int a = std::min(position[i], position[j]), b = std::max(position[i], position[j]);
        earlier[b].push_back(a);
        later[a].push_back(b);
    }
    const std::vector<int> parent = elimination_tree(earlier);
    std::vector<Front> fronts = fundamental_fronts(factor_columns(later, parent), parent);
    amalgamate(fronts);

    const std::vector<int> front_order = postorder(fronts);
    vertex_.clear();
    for (int f : front_order)
        for (int column : fronts[f].column) {
            position[column] = static_cast<int>(vertex_.size());  // from now on: by old position
            vertex_.push_back(order[column]);
        }
    int begin = 0;
    for (int f : front_order) {
        const int width = static_cast<int>(fronts[f].column.size());
        std::vector<int> rows(width);
        std::iota(rows.begin(), rows.end(), begin);
        for (int r : fronts[f].below) rows.push_back(position[r]);
        std::sort(rows.begin(), rows.end());
        add_supernodes(begin, width, rows);
        begin += width;
    }
    for (int r : row_) row_vertex_.push_back(vertex_[r]);
}

/// Splits evenly what is too wide for its panel to stay in the cache.
void BlockSymbolic::add_supernodes(int begin, int width, const std::vector<int>& rows) {
    const int parts = (width + max_width - 1) / max_width;
    for (int part = 0; part < parts; ++part) {
        const int first = width * part / parts, last = width * (part + 1) / parts;
        Supernode supernode{};
        supernode.begin = begin + first;
        supernode.end = begin + last;
        supernode.row_begin = static_cast<int>(row_.size());
        row_.insert(row_.end(), rows.begin() + first, rows.end());
        supernode.row_end = static_cast<int>(row_.size());
        supernode_.push_back(supernode);
    }
}

void BlockSymbolic::list_entries() {
    std::vector<int> position(vertex_count_), supernode_of(vertex_count_);
    for (int k = 0; k < vertex_count_; ++k) position[vertex_[k]] = k;
    for (int s = 0; s < static_cast<int>(supernode_.size()); ++s)
        for (int k = supernode_[s].begin; k < supernode_[s].end; ++k) supernode_of[k] = s;
    std::vector<std::vector<Entry>> by_supernode(supernode_.size());
    const auto list = [&](int slot, int i, int j) {
        const bool transposed = position[i] < position[j];
        const int row = std::max(position[i], position[j]), column = std::min(position[i], position[j]);
        const Supernode& s = supernode_[supernode_of[column]];
        const auto found = std::lower_bound(row_.begin() + s.row_begin, row_.begin() + s.row_end, row);
        by_supernode[supernode_of[column]].push_back({.slot = slot,
                                                      .row = static_cast<int>(found - row_.begin()) - s.row_begin,
                                                      .column = column - s.begin,
                                                      .transposed = transposed});
    };
    for (int v = 0; v < vertex_count_; ++v) list(v, v, v);
    for (size_t k = 0; k < pair_.size(); ++k)
        list(vertex_count_ + static_cast<int>(k), pair_[k].first, pair_[k].second);
    for (size_t s = 0; s < supernode_.size(); ++s) {
        supernode_[s].entry_begin = static_cast<int>(entry_.size());
        entry_.insert(entry_.end(), by_supernode[s].begin(), by_supernode[s].end());
        supernode_[s].entry_end = static_cast<int>(entry_.size());
    }
}

void BlockSymbolic::list_updates() {
    std::vector<int> supernode_of(vertex_count_);
    for (int s = 0; s < static_cast<int>(supernode_.size()); ++s)
        for (int k = supernode_[s].begin; k < supernode_[s].end; ++k) supernode_of[k] = s;
    std::vector<std::vector<Update>> by_supernode(supernode_.size());
    for (int s = 0; s < static_cast<int>(supernode_.size()); ++s) {
        const int* row = row_.data() + supernode_[s].row_begin;
        const int height = supernode_[s].height();
        for (int first = supernode_[s].width(), last = first; first < height; first = last) {
            const int owner = supernode_of[row[first]];
            while (last < height && row[last] < supernode_[owner].end) ++last;
            by_supernode[owner].push_back(
                {.descendant = s, .first = first, .last = last, .target = static_cast<int>(target_.size())});
            int k = supernode_[owner].row_begin;
            for (int r = first; r < height; ++r) {
                while (row_[k] != row[r]) ++k;
                target_.push_back(k - supernode_[owner].row_begin);
            }
        }
    }
    for (size_t s = 0; s < supernode_.size(); ++s) {
        supernode_[s].update_begin = static_cast<int>(update_.size());
        update_.insert(update_.end(), by_supernode[s].begin(), by_supernode[s].end());
        supernode_[s].update_end = static_cast<int>(update_.size());
    }
}

int BlockSymbolic::slot(int i, int j) const {
    if (i < j) std::swap(i, j);
    if (j < 0 || i >= vertex_count_) throw Error("a block outside the matrix was asked for");
    if (i == j) return i;
    const auto first = pair_.begin() + pair_start_[j], last = pair_.begin() + pair_start_[j + 1];
    const auto found = std::lower_bound(first, last, i, [](const auto& pair, int row) { return pair.first < row; });
    if (found == last || found->first != i) throw Error("a block outside the matrix' vertex graph was asked for");
    return vertex_count_ + static_cast<int>(found - pair_.begin());
}

std::int64_t BlockSymbolic::factor_nonzeros() const {
    std::int64_t count = 0;
    for (const auto& s : supernode_)
        count += static_cast<std::int64_t>(s.width()) * s.height() - s.width() * (s.width() - 1) / 2;
    return count;
}

}  // namespace toile

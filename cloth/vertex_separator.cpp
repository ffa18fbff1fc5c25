#include "cloth/vertex_separator.h"

#include <algorithm>
#include <climits>
#include <numeric>
#include <utility>

namespace toile {
namespace {

constexpr char separator = 2;

/// A split while it is being improved.
struct Split {
    std::vector<char> part;
    long weight[3] = {0, 0, 0};

    void put(const WeightedGraph& graph, int v, char to) {
        weight[static_cast<int>(part[v])] -= graph.vertex_weight[v];
        weight[static_cast<int>(to)] += graph.vertex_weight[v];
        part[v] = to;
    }
    void weigh(const WeightedGraph& graph) {
        std::fill(weight, weight + 3, 0L);
        for (int v = 0; v < graph.vertex_count(); ++v) weight[static_cast<int>(part[v])] += graph.vertex_weight[v];
    }
    long larger() const { return std::max(weight[0], weight[1]); }
    /// What is minimised: the separator, with a price on parts that are too unequal; then inequality itself.
    std::pair<long, long> cost() const {
        const long total = weight[0] + weight[1] + weight[2];
        const long excess = std::max(0L, 20 * larger() - 11 * total) / 20;
        return {weight[2] + 2 * excess, larger()};
    }
};

/// Each vertex' partner in a heavy-edge matching, or itself.
std::vector<int> match(const WeightedGraph& graph, int heaviest) {
    const int n = graph.vertex_count();
    std::vector<int> order(n), partner(n, -1);
    std::iota(order.begin(), order.end(), 0);
    const auto degree = [&](int v) { return graph.start[v + 1] - graph.start[v]; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return degree(a) < degree(b); });
    for (int v : order) {
        if (partner[v] >= 0) continue;
        int best = v;
        std::pair<int, int> best_key{0, INT_MIN};
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const int u = graph.neighbour[k];
            if (partner[u] >= 0 || graph.vertex_weight[u] + graph.vertex_weight[v] > heaviest) continue;
            const std::pair key{graph.edge_weight[k], -graph.vertex_weight[u]};
            if (key > best_key) best = u, best_key = key;
        }
        partner[v] = best;
        partner[best] = v;
    }
    return partner;
}

/// The graph with partners merged; `coarse_of` tells where each vertex went.
WeightedGraph contract(const WeightedGraph& graph, const std::vector<int>& partner, std::vector<int>& coarse_of) {
    const int n = graph.vertex_count();
    WeightedGraph coarse;
    std::vector<int> first;
    coarse_of.assign(n, -1);
    for (int v = 0; v < n; ++v) {
        if (partner[v] < v) continue;
        coarse_of[v] = coarse_of[partner[v]] = static_cast<int>(first.size());
        first.push_back(v);
        coarse.vertex_weight.push_back(graph.vertex_weight[v] + (partner[v] > v ? graph.vertex_weight[partner[v]] : 0));
    }
    std::vector<int> place(first.size(), -1);
    coarse.start.push_back(0);
    for (int c = 0; c < static_cast<int>(first.size()); ++c) {
        const int begin = coarse.start.back();
        const auto take = [&](int v) {
            for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
                const int d = coarse_of[graph.neighbour[k]];
                if (d == c) continue;
                if (place[d] < begin) {
                    place[d] = static_cast<int>(coarse.neighbour.size());
                    coarse.neighbour.push_back(d);
                    coarse.edge_weight.push_back(0);
                }
                coarse.edge_weight[place[d]] += graph.edge_weight[k];
            }
        };
        take(first[c]);
        if (partner[first[c]] != first[c]) take(partner[first[c]]);
        coarse.start.push_back(static_cast<int>(coarse.neighbour.size()));
    }
    return coarse;
}

/// Fall of the separator's weight when v of the separator joins `side`: v leaves it, its neighbours of the other side
/// enter.
long gain(const WeightedGraph& graph, const Split& split, int v, char side) {
    long gain = graph.vertex_weight[v];
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
        if (split.part[graph.neighbour[k]] == 1 - side) gain -= graph.vertex_weight[graph.neighbour[k]];
    return gain;
}

struct Move {
    int vertex;
    char from;
};

/// Moves v to `side` and its neighbours of the other side into the separator; notes what was where.
void move_vertex(const WeightedGraph& graph, Split& split, int v, char side, std::vector<int>& members,
                 std::vector<Move>& history) {
    history.push_back({v, separator});
    split.put(graph, v, side);
    std::erase(members, v);
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
        const int u = graph.neighbour[k];
        if (split.part[u] != 1 - side) continue;
        history.push_back({u, split.part[u]});
        split.put(graph, u, separator);
        members.push_back(u);
    }
}

/// One pass of single moves, each the best there is, also uphill; ends at the best split met. False if that is the
/// first.
bool refine_once(const WeightedGraph& graph, Split& split) {
    std::vector<int> members;
    for (int v = 0; v < graph.vertex_count(); ++v)
        if (split.part[v] == separator) members.push_back(v);
    std::vector<char> locked(graph.vertex_count(), 0);
    std::vector<Move> history;
    const auto first_cost = split.cost();
    auto best_cost = first_cost;
    size_t best_length = 0;
    const int patience = 30 + std::min(static_cast<int>(members.size()) / 2, 200);
    for (int idle = 0; idle < patience; ++idle) {
        int best = -1;
        char best_side = 0;
        std::pair<long, long> best_gain{LONG_MIN, LONG_MIN};
        for (int v : members) {
            if (locked[v]) continue;
            for (char side = 0; side < 2; ++side) {
                const long total = split.weight[0] + split.weight[1] + split.weight[2];
                if (20 * (split.weight[static_cast<int>(side)] + graph.vertex_weight[v]) > 13 * total) continue;
                const std::pair key{gain(graph, split, v, side), -split.weight[static_cast<int>(side)]};
                if (key > best_gain) best = v, best_side = side, best_gain = key;
            }
        }
        if (best < 0) break;
        locked[best] = 1;
        move_vertex(graph, split, best, best_side, members, history);
        if (split.cost() < best_cost) {
            best_cost = split.cost();
            best_length = history.size();
            idle = -1;
        }
    }
    while (history.size() > best_length) {
        split.put(graph, history.back().vertex, history.back().from);
        history.pop_back();
    }
    return best_cost < first_cost;
}

void refine(const WeightedGraph& graph, Split& split) {
    for (int pass = 0; pass < 6 && refine_once(graph, split); ++pass) {
    }
}

/// Grows part 0 from `seed` to half of the weight, its outermost layer being the separator.
Split grow(const WeightedGraph& graph, int seed) {
    const int n = graph.vertex_count();
    Split split;
    split.part.assign(n, 1);
    split.weigh(graph);
    const long half = split.weight[1] / 2;
    std::vector<int> queue;
    std::vector<char> reached(n, 0);
    for (int k = 0, next = seed; static_cast<int>(queue.size()) < n; next = (next + 1) % n) {
        if (reached[next]) continue;
        reached[next] = 1;
        queue.push_back(next);
        for (; k < static_cast<int>(queue.size()); ++k)
            for (int e = graph.start[queue[k]]; e < graph.start[queue[k] + 1]; ++e)
                if (!reached[graph.neighbour[e]]) {
                    reached[graph.neighbour[e]] = 1;
                    queue.push_back(graph.neighbour[e]);
                }
    }
    for (int v : queue) {
        if (split.weight[0] + graph.vertex_weight[v] / 2 >= half) break;
        split.put(graph, v, 0);
    }
    for (int v = 0; v < n; ++v) {
        if (split.part[v] != 0) continue;
        for (int e = graph.start[v]; e < graph.start[v + 1]; ++e)
            if (split.part[graph.neighbour[e]] == 1) {
                split.put(graph, v, separator);
                break;
            }
    }
    return split;
}

Split split_coarsest(const WeightedGraph& graph) {
    const int n = graph.vertex_count(), tries = std::min(n, 24);
    Split best;
    for (int t = 0; t < tries; ++t) {
        Split split = grow(graph, static_cast<int>(static_cast<long>(n) * t / tries));
        refine(graph, split);
        if (best.part.empty() || split.cost() < best.cost()) best = std::move(split);
    }
    return best;
}

Split split_graph(const WeightedGraph& graph) {
    constexpr int coarsest = 80;
    const int n = graph.vertex_count();
    if (n <= coarsest) return split_coarsest(graph);
    const long total = std::accumulate(graph.vertex_weight.begin(), graph.vertex_weight.end(), 0L);
    std::vector<int> coarse_of;
    const WeightedGraph coarse =
        contract(graph, match(graph, static_cast<int>(3 * total / (2 * coarsest) + 1)), coarse_of);
    if (coarse.vertex_count() > n - n / 20) return split_coarsest(graph);
    const Split found = split_graph(coarse);
    Split split;
    split.part.resize(n);
    for (int v = 0; v < n; ++v) split.part[v] = found.part[coarse_of[v]];
    split.weigh(graph);
    // Where no small separator is in sight, moves would take long and not bring one.
    if (3 * split.weight[2] < total) refine(graph, split);
    return split;
}

}  // namespace

std::vector<char> separate(const WeightedGraph& graph) {
    if (graph.vertex_count() == 0) return {};
    return split_graph(graph).part;
}

}  // namespace toile

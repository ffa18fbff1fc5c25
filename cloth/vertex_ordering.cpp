#include "cloth/vertex_ordering.h"

#include <cholmod.h>

#include <algorithm>
#include <numeric>

#include "cloth/error.h"
#include "cloth/vertex_separator.h"

namespace toile {
namespace {

/// Parts of at most this many vertices are left to minimum degree.
constexpr int leaf_size = 64;

/// Numbers parts so that each comes before the separator that cuts it off.
class Dissection {
  public:
    Dissection(int vertex_count, const std::vector<std::pair<int, int>>& pairs)
        : start_(vertex_count + 1, 0), neighbour_(2 * pairs.size()), local_(vertex_count, -1), part_(vertex_count, 0) {
        for (const auto& [i, j] : pairs) ++start_[i + 1], ++start_[j + 1];
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        std::vector<int> next(start_.begin(), start_.end() - 1);
        // In two passes each list is rising: first the smaller neighbours, then the larger.
        for (const auto& [i, j] : pairs) neighbour_[next[i]++] = j;
        for (const auto& [i, j] : pairs) neighbour_[next[j]++] = i;
        std::vector<int> all(vertex_count);
        std::iota(all.begin(), all.end(), 0);
        dissect(all);
    }

    /// By vertex; fewer than there are vertices.
    std::vector<int>& part() { return part_; }

  private:
    void dissect(const std::vector<int>& vertices) {
        std::vector<int> side[3];
        if (static_cast<int>(vertices.size()) > leaf_size) {
            const std::vector<char> split = separate(induced_graph(vertices));
            for (size_t k = 0; k < vertices.size(); ++k) side[static_cast<int>(split[k])].push_back(vertices[k]);
        }
        if (side[0].empty() || side[1].empty() || 3 * side[2].size() > vertices.size()) {
            for (int v : vertices) part_[v] = part_count_;
            ++part_count_;
            return;
        }
        dissect(side[0]);
        dissect(side[1]);
        for (int v : side[2]) part_[v] = part_count_;
        if (!side[2].empty()) ++part_count_;
    }

    WeightedGraph induced_graph(const std::vector<int>& vertices) {
        WeightedGraph graph;
        graph.vertex_weight.assign(vertices.size(), 1);
        for (size_t k = 0; k < vertices.size(); ++k) local_[vertices[k]] = static_cast<int>(k);
        graph.start.push_back(0);
        for (int v : vertices) {
            for (int e = start_[v]; e < start_[v + 1]; ++e)
                if (local_[neighbour_[e]] >= 0) graph.neighbour.push_back(local_[neighbour_[e]]);
            graph.start.push_back(static_cast<int>(graph.neighbour.size()));
        }
        graph.edge_weight.assign(graph.neighbour.size(), 1);
        for (int v : vertices) local_[v] = -1;
        return graph;
    }

    std::vector<int> start_, neighbour_;
    std::vector<int> local_;  // index within the part that is being dissected, or -1
    std::vector<int> part_;
    int part_count_ = 0;
};

/// CHOLMOD's minimum degree, within the order of the parts.
std::vector<int> minimum_degree(int vertex_count, const std::vector<std::pair<int, int>>& pairs, int* part) {
    std::vector<int> order(vertex_count);
    std::iota(order.begin(), order.end(), 0);
    if (pairs.empty()) return order;

    std::vector<int> column_start(vertex_count + 1, 0), row(pairs.size());
    for (const auto& pair : pairs) ++column_start[pair.second + 1];
    std::partial_sum(column_start.begin(), column_start.end(), column_start.begin());
    std::vector<int> next(column_start.begin(), column_start.end() - 1);
    for (const auto& [i, j] : pairs) row[next[j]++] = i;

    cholmod_sparse pattern{};
    pattern.nrow = pattern.ncol = static_cast<size_t>(vertex_count);
    pattern.nzmax = row.size();
    pattern.p = column_start.data();
    pattern.i = row.data();
    pattern.stype = -1;
    pattern.itype = CHOLMOD_INT;
    pattern.xtype = CHOLMOD_PATTERN;
    pattern.packed = 1;
    cholmod_common common;
    cholmod_start(&common);
    common.print = 0;
    const bool ordered = cholmod_camd(&pattern, nullptr, 0, part, order.data(), &common);
    cholmod_finish(&common);
    if (!ordered) throw Error("the matrix could not be ordered for Cholesky: out of memory");
    return order;
}

}  // namespace

std::vector<int> order_vertices(int vertex_count, const std::vector<std::pair<int, int>>& pairs) {
    return minimum_degree(vertex_count, pairs, Dissection(vertex_count, pairs).part().data());
}

}  // namespace toile

#pragma once

#include <utility>
#include <vector>

namespace toile {

/// Elimination order of a graph's vertices with little fill: entry k is the vertex at position k. Nested dissection
/// down to small parts, then minimum degree within the parts and separators (CHOLMOD's CAMD). Depends on nothing but
/// the graph, unlike METIS' ordering, which uses the process's random numbers; the fill is about the same. `pairs` are
/// (i, j) with i > j, each once, in lexicographic order of (j, i).
std::vector<int> order_vertices(int vertex_count, const std::vector<std::pair<int, int>>& pairs);

}  // namespace toile

#pragma once

#include <utility>
#include <vector>

namespace toile {

/// Elimination order of a graph's vertices with little fill, by approximate minimum degree (CHOLMOD's AMD): entry k is
/// the vertex at position k, in a postorder of the elimination tree. Depends on nothing but the graph. `pairs` are (i,
/// j) with i > j, each once.
std::vector<int> order_vertices(int vertex_count, const std::vector<std::pair<int, int>>& pairs);

}  // namespace toile

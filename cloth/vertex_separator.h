#pragma once

#include <vector>

namespace toile {

/// An undirected graph with weights; each edge stands at both its ends.
struct WeightedGraph {
    std::vector<int> start;        ///< by vertex, into `neighbour`
    std::vector<int> neighbour;    ///< rising for each vertex
    std::vector<int> edge_weight;  ///< as `neighbour`
    std::vector<int> vertex_weight;

    int vertex_count() const { return static_cast<int>(vertex_weight.size()); }
};

/// Splits a graph in two parts of about equal weight with no edge between them: 0 and 1 for the parts, 2 for the few
/// vertices that separate them. Multilevel, as METIS does it (Karypis and Kumar 1998): matched vertices are merged
/// until few are left, those are split, and the separator is refined on the way back by moves of single vertices
/// (Fiduccia and Mattheyses 1982). No random numbers: the same graph is always split the same way.
std::vector<char> separate(const WeightedGraph& graph);

}  // namespace toile

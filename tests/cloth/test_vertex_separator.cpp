#include <gtest/gtest.h>

#include <algorithm>

#include "cloth/vertex_separator.h"
#include "tests/cloth/vertex_graphs.h"

namespace toile {
namespace {

WeightedGraph weighted(const VertexGraph& graph) {
    std::vector<std::vector<int>> neighbours(graph.vertex_count);
    for (const auto& [i, j] : graph.pairs) {
        if (i == j) continue;
        neighbours[i].push_back(j);
        neighbours[j].push_back(i);
    }
    WeightedGraph result;
    result.vertex_weight.assign(graph.vertex_count, 1);
    result.start.push_back(0);
    for (auto& list : neighbours) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        result.neighbour.insert(result.neighbour.end(), list.begin(), list.end());
        result.start.push_back(static_cast<int>(result.neighbour.size()));
    }
    result.edge_weight.assign(result.neighbour.size(), 1);
    return result;
}

std::vector<int> part_sizes(const std::vector<char>& part) {
    std::vector<int> size(3, 0);
    for (char p : part) ++size.at(static_cast<size_t>(p));
    return size;
}

class SeparatorGraph : public testing::TestWithParam<VertexGraph> {};

TEST_P(SeparatorGraph, NoEdgeJoinsTheParts) {
    const WeightedGraph graph = weighted(GetParam());
    const std::vector<char> part = separate(graph);
    ASSERT_EQ(part.size(), static_cast<size_t>(graph.vertex_count()));
    for (int v = 0; v < graph.vertex_count(); ++v)
        for (int e = graph.start[v]; e < graph.start[v + 1]; ++e)
            EXPECT_NE(part[v] + part[graph.neighbour[e]], 1) << v << " and " << graph.neighbour[e];
}

TEST_P(SeparatorGraph, TheSameGraphIsSplitTheSameWay) {
    const WeightedGraph graph = weighted(GetParam());
    EXPECT_EQ(separate(graph), separate(graph));
}

INSTANTIATE_TEST_SUITE_P(Graphs, SeparatorGraph, testing::ValuesIn(vertex_graphs()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

TEST(VertexSeparator, CutsAGridAcrossItsShortSide) {
    const std::vector<int> size = part_sizes(separate(weighted(grid_graph("", 20, 60, false))));
    EXPECT_LE(size[2], 22);  // a straight cut has 20 vertices
    EXPECT_GE(std::min(size[0], size[1]), 400);
}

TEST(VertexSeparator, CutsATubeByARing) {
    const std::vector<int> size = part_sizes(separate(weighted(grid_graph("", 24, 80, true))));
    EXPECT_LE(size[2], 27);  // a ring has 24
    EXPECT_GE(std::min(size[0], size[1]), 600);
}

TEST(VertexSeparator, LeavesSeparateComponentsWhole) {
    VertexGraph two = grid_graph("", 10, 20, false);
    for (const auto& [i, j] : grid_graph("", 10, 20, false).pairs) two.pairs.emplace_back(i + 200, j + 200);
    two.vertex_count = 400;
    const std::vector<int> size = part_sizes(separate(weighted(two)));
    EXPECT_LE(size[2], 2);
    EXPECT_GE(std::min(size[0], size[1]), 170);
}

TEST(VertexSeparator, TakesNoVertices) {
    WeightedGraph graph;
    graph.start.push_back(0);
    EXPECT_TRUE(separate(graph).empty());
}

}  // namespace
}  // namespace toile

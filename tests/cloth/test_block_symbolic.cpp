#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cloth/block_symbolic.h"
#include "cloth/error.h"
#include "tests/cloth/vertex_graphs.h"

namespace toile {
namespace {

TEST(BlockSymbolic, NumbersDiagonalBlocksThenPairs) {
    const BlockSymbolic symbolic(4, {{0, 2}, {3, 1}, {2, 0}, {2, 1}, {1, 1}});
    EXPECT_EQ(symbolic.slot_count(), 7);
    EXPECT_THAT(symbolic.pair(), testing::ElementsAre(std::pair(2, 0), std::pair(2, 1), std::pair(3, 1)));
    EXPECT_EQ(symbolic.slot(3, 3), 3);
    EXPECT_EQ(symbolic.slot(2, 0), 4);
    EXPECT_EQ(symbolic.slot(0, 2), 4);
    EXPECT_EQ(symbolic.slot(1, 3), 6);
}

TEST(BlockSymbolic, RefusesWhatIsNotInTheGraph) {
    EXPECT_THROW(BlockSymbolic(3, {{0, 3}}), Error);
    EXPECT_THROW(BlockSymbolic(3, {{-1, 2}}), Error);
    const BlockSymbolic symbolic(3, {{0, 1}});
    EXPECT_THROW(symbolic.slot(0, 2), Error);
    EXPECT_THROW(symbolic.slot(3, 3), Error);
    EXPECT_THROW(symbolic.slot(0, -1), Error);
}

TEST(BlockSymbolic, TakesNoVertices) {
    const BlockSymbolic symbolic(0, {});
    EXPECT_EQ(symbolic.slot_count(), 0);
    EXPECT_EQ(symbolic.factor_nonzeros(), 0);
}

/// Rows of each column of the factor by the plain rule, in the object's own order of elimination.
std::vector<std::set<int>> columns_by_elimination(const BlockSymbolic& symbolic) {
    const int n = symbolic.vertex_count();
    std::vector<int> position(n);
    for (int k = 0; k < n; ++k) position[symbolic.vertex()[k]] = k;
    std::vector<std::set<int>> column(n);
    for (int k = 0; k < n; ++k) column[k].insert(k);
    for (const auto& [i, j] : symbolic.pair())
        column[std::min(position[i], position[j])].insert(std::max(position[i], position[j]));
    for (int k = 0; k < n; ++k) {
        const auto below = std::next(column[k].begin());
        if (below != column[k].end()) column[*below].insert(below, column[k].end());
    }
    return column;
}

class BlockSymbolicGraph : public testing::TestWithParam<VertexGraph> {};

TEST_P(BlockSymbolicGraph, EliminatesEveryVertexOnce) {
    const BlockSymbolic symbolic(GetParam().vertex_count, GetParam().pairs);
    std::vector<int> vertices = symbolic.vertex();
    std::sort(vertices.begin(), vertices.end());
    ASSERT_EQ(vertices.size(), static_cast<size_t>(GetParam().vertex_count));
    for (int v = 0; v < GetParam().vertex_count; ++v) EXPECT_EQ(vertices[v], v);
    int next = 0;
    for (const auto& s : symbolic.supernode()) {
        EXPECT_EQ(s.begin, next);
        EXPECT_GT(s.width(), 0);
        EXPECT_LE(s.width(), BlockSymbolic::max_width);
        next = s.end;
    }
    EXPECT_EQ(next, GetParam().vertex_count);
}

TEST_P(BlockSymbolicGraph, SupernodesHoldTheFill) {
    const BlockSymbolic symbolic(GetParam().vertex_count, GetParam().pairs);
    const auto columns = columns_by_elimination(symbolic);
    std::int64_t fill = 0;
    for (const auto& s : symbolic.supernode()) {
        const std::vector<int> rows(symbolic.row().begin() + s.row_begin, symbolic.row().begin() + s.row_end);
        EXPECT_TRUE(std::adjacent_find(rows.begin(), rows.end(), std::greater_equal<>()) == rows.end());
        for (int k = s.begin; k < s.end; ++k) {
            EXPECT_EQ(rows[k - s.begin], k);
            EXPECT_TRUE(std::includes(rows.begin(), rows.end(), columns[k].begin(), columns[k].end()));
            fill += static_cast<std::int64_t>(columns[k].size());
        }
    }
    EXPECT_GE(symbolic.factor_nonzeros(), fill);
}

TEST_P(BlockSymbolicGraph, UpdatesMapEveryRowOfEveryDescendant) {
    const BlockSymbolic symbolic(GetParam().vertex_count, GetParam().pairs);
    size_t mapped = 0;
    for (int j = 0; j < static_cast<int>(symbolic.supernode().size()); ++j) {
        const auto& target = symbolic.supernode()[j];
        for (int u = target.update_begin; u < target.update_end; ++u) {
            const auto& update = symbolic.update()[u];
            ASSERT_LT(update.descendant, j);
            const auto& source = symbolic.supernode()[update.descendant];
            mapped += static_cast<size_t>(update.last - update.first);
            for (int r = update.first; r < source.height(); ++r) {
                const int row = symbolic.row()[source.row_begin + r];
                EXPECT_EQ(row, symbolic.row()[target.row_begin + symbolic.target()[update.target + r - update.first]]);
                EXPECT_EQ(r < update.last, row < target.end);
            }
        }
    }
    size_t below = 0;
    for (const auto& s : symbolic.supernode()) below += static_cast<size_t>(s.height() - s.width());
    EXPECT_EQ(mapped, below);
}

TEST_P(BlockSymbolicGraph, PutsEverySlotInOnePlace) {
    const BlockSymbolic symbolic(GetParam().vertex_count, GetParam().pairs);
    std::set<int> slots;
    for (const auto& s : symbolic.supernode())
        for (int e = s.entry_begin; e < s.entry_end; ++e) {
            const auto& entry = symbolic.entry()[e];
            EXPECT_TRUE(slots.insert(entry.slot).second);
            const int row = symbolic.row_vertex()[s.row_begin + entry.row],
                      column = symbolic.vertex()[s.begin + entry.column];
            EXPECT_EQ(entry.slot, symbolic.slot(row, column));
            EXPECT_EQ(entry.transposed, row < column);
        }
    EXPECT_EQ(slots.size(), static_cast<size_t>(symbolic.slot_count()));
}

TEST_P(BlockSymbolicGraph, DependsOnTheGraphAlone) {
    auto pairs = GetParam().pairs;
    const BlockSymbolic first(GetParam().vertex_count, pairs);
    std::reverse(pairs.begin(), pairs.end());
    for (auto& pair : pairs) std::swap(pair.first, pair.second);
    const BlockSymbolic second(GetParam().vertex_count, pairs);
    EXPECT_EQ(first.vertex(), second.vertex());
    EXPECT_EQ(first.row(), second.row());
    EXPECT_EQ(first.target(), second.target());
}

INSTANTIATE_TEST_SUITE_P(Graphs, BlockSymbolicGraph, testing::ValuesIn(vertex_graphs()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

TEST(BlockSymbolic, InAnotherGraphsOrderEliminatesAFewPairsMore) {
    std::vector<std::pair<int, int>> grid;
    const int side = 20;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const int v = row * side + column;
            if (column + 1 < side) grid.emplace_back(v, v + 1);
            if (row + 1 < side) grid.emplace_back(v, v + side);
        }
    const BlockSymbolic plain(side * side, grid);
    std::vector<std::pair<int, int>> more = grid;
    more.emplace_back(3, side * side - 5);
    more.emplace_back(4, side * side - 5);
    const BlockSymbolic coupled(plain, more);
    EXPECT_EQ(coupled.slot_count(), plain.slot_count() + 2);
    EXPECT_NO_THROW(coupled.slot(3, side * side - 5));
    EXPECT_GE(coupled.factor_nonzeros(), plain.factor_nonzeros());
    EXPECT_LT(static_cast<double>(coupled.factor_nonzeros()), 1.3 * static_cast<double>(plain.factor_nonzeros()));
}

TEST(BlockSymbolic, KeepsTheFillOfALongTubeSmall) {
    // A tube of 12 vertices around and 400 long: a band of 13 rows is what any ordering along it needs.
    const VertexGraph tube = grid_graph("", 12, 400, true);
    const BlockSymbolic symbolic(tube.vertex_count, tube.pairs);
    EXPECT_LT(symbolic.factor_nonzeros(), 25 * tube.vertex_count);
}

}  // namespace
}  // namespace toile

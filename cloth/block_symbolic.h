#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace toile {

/// What the Cholesky factorisations of all symmetric matrices on one vertex graph share: slots of the values, ordering,
/// supernodes and the lists that a left-looking numeric phase walks. Built once, then const: any number of
/// `LaneCholesky` and `ScalarCholesky` in any number of threads may use one object.
///
/// Values have one slot for each vertex and each pair of the graph: slot v is the diagonal block of vertex v, then come
/// the pairs (i, j), i > j, in lexicographic order of (j, i). The result depends on nothing but the graph.
class BlockSymbolic {
  public:
    /// `pairs` are vertex pairs in any order, repeated as they come. Throws Error if one is out of range.
    BlockSymbolic(int vertex_count, std::vector<std::pair<int, int>> pairs);
    /// In the order of another graph with as many vertices: a tenth of the time, and little more fill where there are
    /// only a few pairs more.
    BlockSymbolic(const BlockSymbolic& other, std::vector<std::pair<int, int>> pairs);

    int vertex_count() const { return vertex_count_; }
    /// Number of slots: vertices + pairs.
    int slot_count() const { return vertex_count_ + static_cast<int>(pair_.size()); }
    /// Slot of the pair {i, j} in either order; of the diagonal block where i == j. Throws Error if there is none.
    /// Whichever way it is asked, the block stored there has the larger vertex' rows and the smaller one's columns.
    int slot(int i, int j) const;
    /// Pairs (i, j), i > j, of the slots from V on.
    const std::vector<std::pair<int, int>>& pair() const { return pair_; }

    /// Entries of the factor as a V x V matrix, lower triangle with diagonal and with the zeros that supernodes store;
    /// of the 3V x 3V matrix it has about nine times as many.
    std::int64_t factor_nonzeros() const;

    // What follows is for the numeric phase. Positions are vertices in elimination order.

    /// Consecutive positions [begin, end) that are eliminated together: all columns share the rows below.
    struct Supernode {
        int begin, end;                ///< positions
        int row_begin, row_end;        ///< rows in `row()`: the supernode's own positions, then those below, rising
        int entry_begin, entry_end;    ///< its part of `entry()`
        int update_begin, update_end;  ///< its part of `update()`
        int width() const { return end - begin; }
        int height() const { return row_end - row_begin; }
    };
    /// A value that belongs into a supernode's panel.
    struct Entry {
        int slot;
        int row, column;  ///< block row and block column within the panel
        bool transposed;  ///< the block is to be transposed, as the ordering put the larger vertex first
    };
    /// A descendant whose rows [first, last) lie in the supernode's columns; all from `first` on lie in its rows.
    struct Update {
        int descendant;   ///< supernode
        int first, last;  ///< rows of the descendant, counted from its own row_begin
        int target;       ///< `target()[target + r - first]`: block row in the panel of the descendant's row r
    };
    const std::vector<Supernode>& supernode() const { return supernode_; }
    const std::vector<int>& row() const { return row_; }
    const std::vector<int>& row_vertex() const { return row_vertex_; }  ///< the vertices of `row()`
    const std::vector<Entry>& entry() const { return entry_; }
    const std::vector<Update>& update() const { return update_; }
    const std::vector<int>& target() const { return target_; }
    /// The vertex at each position.
    const std::vector<int>& vertex() const { return vertex_; }
    /// No supernode has more columns.
    static constexpr int max_width = 20;

  private:
    void build(const std::vector<int>& order);
    void find_supernodes(const std::vector<int>& order);
    void add_supernodes(int begin, int width, const std::vector<int>& rows);
    void list_entries();
    void list_updates();

    int vertex_count_;
    std::vector<std::pair<int, int>> pair_;
    std::vector<int> pair_start_;  // by smaller vertex, into pair_
    std::vector<int> vertex_;
    std::vector<Supernode> supernode_;
    std::vector<int> row_, row_vertex_;
    std::vector<Entry> entry_;
    std::vector<Update> update_;
    std::vector<int> target_;
};

}  // namespace toile

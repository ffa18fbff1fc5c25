#pragma once

#include <vector>

#include "prior/quasistatic.h"

namespace toile::prior {

/// The quasistatic model as its solvers read it: one spring for each pair of vertices that share a stencil, vertices
/// numbered so that neighbours lie close in memory, no units.
///
/// Edge and bending springs of one pair add up to one spring, k = Σ k_s and k l̄ = Σ k_s l̄_s, up to a constant. The
/// weights of an axial spring add up to zero, so it is a sum over its six pairs, −½ k^A w_i w_j |r_i − r_j|²: a spring
/// of rest length zero, whose stiffness may be negative. Hence for all pairs
///
///     E = Σ ½ k (l − l̄)² + ½ c l²  +  Σ ½ z_i |r̂_i − r_i|²
///
/// Lengths are in `length_unit`, stiffnesses in `stiffness_unit`: powers of two near the mean rest length and edge
/// stiffness, so that a change of units changes no digit beyond those.
struct SpringGraph {
    explicit SpringGraph(const QuasistaticModel& model);
    /// New target stiffnesses of the same model.
    void set_target(const QuasistaticModel& model);

    struct Spring {
        int other;           ///< the pair's larger vertex
        double stiffness;    ///< k
        double rest_length;  ///< l̄
        double axial;        ///< c
    };
    /// What the edge and the bending spring have of a pair: k and k l̄, for derivatives by the moduli.
    struct Share {
        double edge, edge_force, bending, bending_force;
    };
    /// Rows of the lower triangle for the incomplete factor: entry (row, column) of a spring.
    struct Entry {
        int column;
        int spring;
        int update_end;  ///< its updates end here; they begin where those of the entry before end
    };
    /// Subtracts (row, k) D_k⁻¹ (column, k)ᵀ for a k that row and column have in common.
    struct Update {
        int left;   ///< entry (row, k), counted from the row's first
        int right;  ///< entry (column, k)
    };

    int vertex_count = 0;
    double length_unit = 1;      ///< [m]
    double stiffness_unit = 1;   ///< [N/m]
    double reference_force = 0;  ///< mean_e k^L_e l̄_e, of the residual's definition
    std::vector<int> vertex;     ///< `[V]` the model's vertex at each place
    std::vector<double> target;  ///< `[V]` z
    std::vector<int> first;      ///< `[V + 1]` into `spring`, by smaller vertex
    std::vector<Spring> spring;  ///< `[S]`
    std::vector<Share> share;    ///< `[S]`
    std::vector<int> row_first;  ///< `[V + 1]` into `entry`
    std::vector<Entry> entry;    ///< `[S]`
    std::vector<Update> update;
    int widest_row = 0;  ///< most entries of a row

  private:
    struct Pair;
    void add_springs(const std::vector<Pair>& pairs);
    void list_rows();
    void list_updates();
};

}  // namespace toile::prior

#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "cloth/types.h"
#include "prior/quasidefinite_ldl.h"

namespace toile::prior {

/// The linear system behind every step of the cone method: a stiffness for each vertex, one for each edge, and one
/// extra unknown p_e for each edge that carries the stiffness along one direction, however large it is:
///
///     [ K + Σ ω_e B_eᵀ B_e   (g_eᵀ B_e)ᵀ ] [ u ]   [ f ]
///     [ g_eᵀ B_e             −c_e        ] [ p ] = [ h ]          unknowns [3V + E]
///
/// Eliminating p adds g_e g_eᵀ / c_e to edge e. The matrix is quasi-definite for positive K and c, so its LDLᵀ exists
/// for any ordering; where c_e -> 0 the edge is held at its length.
class ConeKkt {
  public:
    ConeKkt(const Edges& edge, int vertex_count);

    /// Starts a matrix: K = diag(k_i), no edges yet.
    void begin(const Eigen::VectorXd& stiffness);
    /// ω_e, g_e and c_e of one edge; once for every edge.
    void set_edge(Eigen::Index e, double transverse, const Eigen::Vector3d& direction, double compliance);
    /// False if the factorisation broke down.
    bool factor();
    /// Solves with iterative refinement; right-hand side and solution are `[3V + E]`. Returns the largest entry of the
    /// residual relative to that of the right-hand side.
    double solve(const Eigen::VectorXd& right, Eigen::VectorXd& solution);

    Eigen::Index size() const { return matrix_.rows(); }
    double factor_nonzeros() const { return ldl_.factor_nonzeros(); }

  private:
    static SparseMatrix pattern_of(const Edges& edge, int vertex_count);

    int vertex_count_;
    Edges edge_;
    SparseMatrix matrix_;  // lower triangle
    QuasidefiniteLdl ldl_;
    std::vector<int> diagonal_slot_;             // `[3V + E]`
    std::vector<std::array<int, 3>> pair_slot_;  // `[E]` entries (3 max + c, 3 min + c)
    std::vector<std::array<int, 6>> row_slot_;   // `[E]` entries (3V + e, 3a + c), then (3V + e, 3b + c)
    Eigen::VectorXd residual_, correction_;
};

}  // namespace toile::prior

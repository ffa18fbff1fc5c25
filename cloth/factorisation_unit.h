#pragma once

#include <memory>
#include <string>

#include "cloth/types.h"

namespace toile {

/// The unit of the speed tables: one numeric CHOLMOD factorisation of a 3V x 3V Hessian on a mesh graph, one thread,
/// with CHOLMOD as it comes.
class FactorisationUnit {
  public:
    /// `edge` `[E x 2]`, `position` `[V x 3]`: the matrix is 1 + Σ_e (n nᵀ + 0.3 (1 − n nᵀ)) ⊗ (edge Laplacian).
    FactorisationUnit(const Edges& edge, const Positions& position);
    ~FactorisationUnit();
    FactorisationUnit(FactorisationUnit&&) noexcept;

    /// One numeric factorisation. False if it failed: it must not be timed then.
    bool factor();
    /// Relative residual of a solve with the factor: shows that it is one.
    double solve_error();
    /// What CHOLMOD chose, such as "METIS, 0.48 M nonzeros".
    std::string description() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile

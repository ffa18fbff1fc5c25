#pragma once

#include <Eigen/Core>
#include <vector>

#include "prior/cone_kkt.h"
#include "prior/cone_program.h"
#include "prior/report.h"

namespace toile::prior {

/// Newton's method on the Karush-Kuhn-Tucker conditions (paper, Equation 2) with the taut edges as equations:
///
///     A = { e : λ_e > κ_e (l_e^max − l_e) }      [ H  Nᵀ ] [ dr ]   [ −(K u + Nᵀ λ) ]
///                                                [ N  −δ ] [ dλ ] = [ l^max − l     ]
///
/// with H and N of method.md, Section 2, and κ_e = k_a k_b / (k_a + k_b), the stiffness that the edge alone feels.
/// Started from an interior point it ends, in a few steps, with edges at their limit to rounding and with multipliers
/// of loose edges that are exactly zero. A is chosen anew for each step; δ keeps the system regular where taut edges
/// are redundant, and costs only speed of convergence elsewhere.
class ConePolish {
  public:
    ConePolish(ConeKkt& kkt, const ConeProgram& program, bool by_largest)
        : kkt_(kkt), program_(program), by_largest_(by_largest) {}

    /// One step from `u` `[3V]`, `lambda` `[E]`, with multipliers >= 0 after it. False if the factorisation broke down.
    bool step(Eigen::VectorXd& u, Eigen::VectorXd& lambda, Report& report);

  private:
    void assemble(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda);

    ConeKkt& kkt_;
    const ConeProgram& program_;
    bool by_largest_;
    Eigen::Matrix3Xd direction_;  // n_e
    std::vector<char> active_;    // of A
    Eigen::VectorXd length_;      // l_e
    Eigen::VectorXd right_, solution_;
};

}  // namespace toile::prior

#pragma once

#include <array>

#include "prior/inextensibility_buffers.h"

namespace toile::prior {

/// One sample's derivative: what goes in, where results go, what came of it. Either `loss_gradient` is set
/// (vector-Jacobian product) or `predicted_change` (Jacobian-vector product).
struct InextensibilityDerivativeLane {
    const double* position = nullptr;          ///< `[V x 3]` r*; null: the lane is not used
    const double* multiplier = nullptr;        ///< `[E]` λ
    const double* loss_gradient = nullptr;     ///< `[V x 3]` ∂L/∂r*
    const double* predicted_change = nullptr;  ///< `[V x 3]`
    const double* limit_change = nullptr;      ///< `[E]`, or null
    double* result = nullptr;                  ///< `[V x 3]` ∂L/∂r̂, or the change of r*
    double* multiplier_result = nullptr;       ///< `[E]` ∂L/∂l_e^max; null: not asked for
    DerivativeReport report{};
};

/// Solves
///
///     [ H  Nᵀ ] [ a ]   [ g ]
///     [ N  0  ] [ b ] = [ h ]
///
/// over the taut edges (method.md, Section 2; paper, Appendix A) for W samples side by side: the matrix H + γ NᵀN is
/// factored once, and each correction with it takes the part 1 / (1 + γ σ) of the error in b, for σ the non-zero
/// eigenvalues of N H⁻¹ Nᵀ. Where N has not full rank, b starts at zero and never leaves the range of N: it comes out
/// of minimal norm, and a is unique.
template <int W>
void differentiate_group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityDerivativeLane, W>& lane,
                         double tolerance);

}  // namespace toile::prior

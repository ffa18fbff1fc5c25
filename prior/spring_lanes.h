#pragma once

#include "prior/float_lanes.h"
#include "prior/spring_graph.h"

namespace toile::prior {

/// Loops over all springs of W samples side by side (cloth/lane.h). Vectors are `[V][3][W]` in the graph's numbering
/// and units, numbers of one lane are `[W]`; all are aligned to `lane_alignment<W>`. Instantiated for W = 1 and 8.

/// The energy at a position. `energy_size` is the sum of the energy's terms without their signs (its rounding error is
/// relative to that), `largest` the largest entry of the gradient, `lost` the largest force k l̄ of a spring without
/// length, whose direction does not exist: it is left out of the gradient.
template <int W>
struct SpringValue {
    alignas(8 * W) double energy[W], energy_size[W], largest[W], lost[W];
};

template <int W>
void evaluate_springs(const SpringGraph& graph, const double* position, const double* predicted, double* gradient,
                      SpringValue<W>& value);

/// The Hessian as springs, `form` `[S][4][W]`, in double precision or single (`SingleLanes`): of each pair it is (a I +
/// m mᵀ) ⊗ (pair Laplacian) with m = (form 0..2), a = form 3. A lane with `exact[lane]` = 0 gets the projected Hessian:
/// its springs' part of a not below zero. And its diagonal blocks `[V][6][W]` (xx, yx, yy, zx, zy, zz), projected where
/// `exact_diagonal` is 0.
template <int W, class Number>
void linearize_springs(const SpringGraph& graph, const double* position, const double* exact,
                       const double* exact_diagonal, Number* form, double* diagonal);

/// product = H x with the Hessian at `position`, straight from there.
template <int W>
void multiply_hessian(const SpringGraph& graph, const double* position, const double* exact, const double* x,
                      double* product);

/// product = H x, and the sums x·Hx and x·x.
template <int W>
void multiply_springs(const SpringGraph& graph, const double* form, const double* x, double* product,
                      double* x_dot_product, double* x_squared);

/// Sums `[3][W]` of x times the gradients of E_edge, E_bending and E_axial at `position`.
template <int W>
void dot_moduli(const SpringGraph& graph, const double* position, const double* x, double* sum);

/// Adds these gradients, times `factor` `[3][W]`, to x.
template <int W>
void add_moduli(const SpringGraph& graph, const double* position, const double* factor, double* x);

}  // namespace toile::prior

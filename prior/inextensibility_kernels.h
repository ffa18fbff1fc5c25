#pragma once

namespace toile::prior {

/// One group of W samples inside the inextensibility prior: pointers into a workspace. Positions are relative to the
/// sample's own origin and in units of the mean edge limit, target stiffnesses in units of their mean.
///
/// The interior point works on the optimality conditions of `InextensibilityModel` with slacks s_e,
///
///     k_i (r_i − r̂_i) + Σ_e λ_e ∂l_e/∂r_i = 0,     l_e + s_e = L_e,     λ_e s_e = μ,     λ, s > 0,
///
/// whose Newton step, with λ and s eliminated, is one system of 3x3 blocks on the mesh graph.
template <int W>
struct InextensibilityLanes {
    int vertex_count, edge_count;
    const int* edge;           ///< `[E][2]`
    const int* slot;           ///< `[E]` of the edge's block
    const double* limit;       ///< `[E]` L_e
    const double* stiffness;   ///< `[V]` k_i
    double* predicted;         ///< `[V][3][W]` r̂
    double* position;          ///< `[V][3][W]` r
    double* stationarity;      ///< `[V][3][W]` left side of the first condition
    double* step;              ///< `[V][3][W]` right-hand side, then the step of r
    double* trial;             ///< `[V][3][W]` the same for a trial correction
    double* direction;         ///< `[E][3][W]` unit edge vectors
    double* primal;            ///< `[E][W]` l + s − L
    double* slack;             ///< `[E][W]` s
    double* multiplier;        ///< `[E][W]` λ
    double* target;            ///< `[E][W]` what a step should add to λ s, without its product of changes
    double* slack_step;        ///< `[E][W]`
    double* multiplier_step;   ///< `[E][W]`
    double* slack_trial;       ///< `[E][W]`
    double* multiplier_trial;  ///< `[E][W]`
    double* split;             ///< `[E][3][W]` edge vectors of the first-order method, each within its limit
    double* dual;              ///< `[E][3][W]` its scaled multipliers
    double* block;             ///< `[slot][9][W]` the matrix
};

/// Largest of the residual's parts, and the mean of λ s; `[W]` each.
struct alignas(64) InextensibilityMeasure {
    double stationarity[8];     ///< |k (r − r̂) + Σ λ ∂l/∂r|_∞
    double force[8];            ///< max_i |k_i (r_i − r̂_i)|_∞
    double overlength[8];       ///< max_e (l_e / L_e − 1)
    double complementarity[8];  ///< max_e λ_e |L_e − l_e| / L_e
    double multiplier[8];       ///< max_e λ_e
    double gap[8];              ///< mean of λ s
};

/// Lets r = r̂ and splits off the edge vectors, cut to their limits; leaves the first sweep's right-hand side in `step`.
template <int W>
void begin_sweeps(const InextensibilityLanes<W>& lanes, double penalty);
/// The rest of a sweep after the solve with K + penalty GᵀG: over-relaxed projection of the edge vectors, new
/// multipliers, next right-hand side in `step`. Takes the solution in `step` to `position`.
template <int W>
void finish_sweep(const InextensibilityLanes<W>& lanes, double penalty);
/// λ and s on the central path of the given μ `[W]`, as near to `position` and `dual` as the smoothed projection brings
/// them.
template <int W>
void smooth_start(const InextensibilityLanes<W>& lanes, double penalty, const double* mu);
/// Largest |penalty · dual| and largest l / L − 1 (zero where no edge is too long), `[W]` each.
template <int W>
void measure_sweeps(const InextensibilityLanes<W>& lanes, double penalty, double* largest, double* overlength);
/// As `begin_sweeps`, from the positions and multipliers of an earlier solution.
template <int W>
void resume_sweeps(const InextensibilityLanes<W>& lanes, double penalty);

/// Residuals at (r, λ, s), the matrix, and in `step` the right-hand side of the affine step.
template <int W>
void linearise(const InextensibilityLanes<W>& lanes, InextensibilityMeasure& measure);
/// The residuals alone, at r and λ.
template <int W>
void measure_solution(const InextensibilityLanes<W>& lanes, InextensibilityMeasure& measure);
/// Ends the affine step from the solved `step`: its product of changes into `target`, the reciprocal of the longest
/// step into `inverse_length` `[W]`.
template <int W>
void measure_affine(const InextensibilityLanes<W>& lanes, double* inverse_length);
/// `target` −λ s − Δs Δλ + centre `[W]`, and its right-hand side in `step`.
template <int W>
void aim_at_centre(const InextensibilityLanes<W>& lanes, const double* centre);
/// Changes of s and λ that belong to the solved `step`, or with `trial` to the solved `trial`.
template <int W>
void measure_step(const InextensibilityLanes<W>& lanes, bool trial, double* inverse_length);
/// Gondzio's centrality correction: pulls the products that a step of length `reach` `[W]` would leave far from
/// `centre` `[W]` towards it; the new right-hand side is left in `trial`.
template <int W>
void aim_at_products(const InextensibilityLanes<W>& lanes, const double* reach, const double* centre);
/// Goes `length` `[W]` along the step, or in the lanes where `use_trial` `[W]` is not zero along the trial step.
template <int W>
void advance(const InextensibilityLanes<W>& lanes, const double* length, const double* use_trial);

/// What `find_taut` counts; `[W]` each.
struct TautMeasure {
    alignas(64) double taut[8];       ///< edges whose multiplier, relative to the largest, exceeds their relative slack
    alignas(64) double weak[8];       ///< edges where both are below `weak_below`
    alignas(64) double distance[8];   ///< the smallest over the edges of the larger of the two
    alignas(64) double curvature[8];  ///< largest λ / l of a taut edge
};

/// The derivative's system at a solution, method.md Section 2, in the buffers of `InextensibilityLanes` under other
/// names: taut edges (`slack`, 1 or 0), λ / l of them (`target`), unit edge vectors (`direction`), right-hand sides
/// (`stationarity` `[V][3]`, `multiplier_trial` `[E]`), and the unknowns (`trial` `[V][3]`, `multiplier_step` `[E]`).
template <int W>
void find_taut(const InextensibilityLanes<W>& lanes, const double* largest_multiplier, double weak_below,
               TautMeasure& measure);
/// H + γ NᵀN, with γ `[W]`.
template <int W>
void assemble_taut(const InextensibilityLanes<W>& lanes, const double* gamma);
/// Residuals of both rows (the second into `slack_trial`), and in `step` the right-hand side of the correction. Largest
/// entries `[W]`.
template <int W>
void taut_residual(const InextensibilityLanes<W>& lanes, const double* gamma, double* force, double* length);
/// Adds the solved correction to the unknowns.
template <int W>
void taut_correction(const InextensibilityLanes<W>& lanes, const double* gamma);

}  // namespace toile::prior

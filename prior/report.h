#pragma once

namespace toile::prior {

/// What came of one sample. The numbers are those of `/samples/status` in a projection file.
enum class Status : signed char {
    converged = 0,             ///< residual <= tolerance
    accuracy_not_reached = 1,  ///< the iteration budget ended first; the best iterate found is returned
    rejected_input = 2         ///< the prediction has a NaN or an infinity; positions are NaN
};

/// How one sample was solved.
struct Report {
    Status status = Status::rejected_input;
    int iterations = 0;           ///< second-order steps (the unit that costs a factorisation)
    int sweeps = 0;               ///< first-order steps on the constant matrix
    double residual = 0;          ///< relative optimality error as `contract.md` defines it, of the positions returned
    double seconds = 0;           ///< wall time divided by the samples that shared it
    double seconds_sweep = 0;     ///< part of `seconds` spent in first-order steps
    double seconds_assembly = 0;  ///< part spent in gradients and Hessians
    double seconds_factor = 0;    ///< part spent in factorisations
    double seconds_solve = 0;     ///< part spent in triangular solves
};

/// How far a derivative can be trusted. Filled by both products (`backward` and `tangent`).
struct DerivativeReport {
    Status status = Status::rejected_input;  ///< accuracy_not_reached: `linear_residual` is above 1e-11
    double linear_residual = 0;  ///< |A x - b| / |b| of the linear system behind the derivative (largest entries)
    int taut_edges = 0;          ///< inextensibility: edges at their limit with a multiplier
    int weakly_active = 0;       ///< inextensibility: edges at their limit without force: the map is one-sided there
    double active_set_distance = 0;  ///< relative distance to the nearest change of the active set (0: at a kink)
    bool positive_definite = true;   ///< quasistatic: false if the exact Hessian is not; see `Quasistatic::backward`
    double seconds = 0;              ///< wall time divided by the samples that shared it
};

}  // namespace toile::prior

#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "prior/quasistatic.h"

namespace toile::evaluate {

/// Pairs of predicted and true cloth, read when they are asked for.
struct MuSamples {
    int count = 0;
    /// Fills in sample `index` of [0, count): r̂ and r_T, `[V x 3]` [m], both finite. Called from one thread.
    std::function<void(int index, std::span<double> predicted, std::span<double> target)> read;
};

struct MuFitOptions {
    prior::QuasistaticStiffness stiffness;
    bool per_vertex = true;         ///< learn μ per vertex after the global one
    double low = 1e-4, high = 1e3;  ///< bounds of μ
    double reference = 0.1;         ///< the paper's μ, which the results are held against; within the bounds
    int samples = 64;               ///< of the train split at most, drawn by `seed`; all of them are kept in memory
    int validation_samples = 32;    ///< of the validation split at most
    /// Weights of the smoothness term that are tried, the stiffest first (see `MuVertexFit`).
    std::vector<double> smoothness{0.1, 0.01, 1e-3, 1e-4, 1e-5};
    int iterations = 20;      ///< of L-BFGS for each weight
    double tolerance = 1e-6;  ///< of the prior's residual
    std::uint64_t seed = 0;
    int jobs = 1;  ///< threads; the result does not depend on it
    std::function<void(const std::string& stage, int done, int total)> progress;  ///< may be empty
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between evaluations; then Interrupted is thrown

    /// Throws Error naming field, value and bound.
    void validate() const;
};

enum class MuStatus {
    converged,        ///< the derivative changes sign, or the loss falls no more
    iterations_used,  ///< the loss still fell
    at_lower_bound,   ///< the loss falls towards the bound: nothing is gained from keeping to the predictions
    at_upper_bound,   ///< the loss falls towards the bound: the predictions are better than what the prior makes of
                      ///< them, as with a predictor that is exact on its train split
    no_derivative     ///< no sample's projection had a derivative: μ is the reference
};
/// "converged", "iterations_used", …
std::string mu_status_name(MuStatus status);

/// One evaluation of the loss.
struct MuStep {
    double mu = 0;         ///< the global μ, or the geometric mean over the vertices
    double error = 0;      ///< √(mean over samples and vertices of |r* − r_T|²) [m]
    double objective = 0;  ///< error² relative to that at the reference, plus the smoothness term
};

/// √(mean |r* − r_T|²) over the samples of one split [m]; NaN without samples.
struct MuErrors {
    double predicted = 0;  ///< of r̂ itself
    double reference = 0;  ///< after the prior with μ = `reference`
    double fitted = 0;     ///< after the prior with the μ learned
};

struct MuGlobalFit {
    double mu = 0;
    MuStatus status = MuStatus::no_derivative;
    std::vector<MuStep> history;  ///< in the order they were made
    MuErrors train, validation;
    double seconds = 0;
};

/// What one weight of the smoothness term brought.
struct MuSmoothness {
    double weight = 0;
    double train = 0, validation = 0;  ///< errors [m]
    int evaluations = 0;
    MuStatus status = MuStatus::no_derivative;
};

struct MuVertexFit {
    Eigen::VectorXd mu;  ///< `[V]`; empty where it was not asked for
    MuStatus status = MuStatus::no_derivative;
    double smoothness = 0;            ///< the weight chosen
    std::vector<MuSmoothness> tried;  ///< in the order they were tried
    std::vector<MuStep> history;      ///< of the weight chosen
    MuErrors train, validation;
    double seconds = 0;
};

struct MuFit {
    MuGlobalFit global;
    MuVertexFit vertex;
    int samples = 0, validation_samples = 0;  ///< that were used
    int samples_offered = 0;                  ///< train samples there were
    int left_out = 0;      ///< most train samples that one evaluation left out of the derivative: their Hessian was not
                           ///< positive definite, or the solver did not reach its accuracy
    std::string sentence;  ///< what came of it, for a report
};

/// Learns the stiffness of the quasistatic prior's target springs on the train split (paper, Section 6.2; method.md,
/// Section 3): the μ that minimises Σ |r*(μ) − r_T|², for predictions as they are.
///
/// Global: the loss is scanned once a decade over a few samples, then the root of its derivative in log μ, which
/// `Quasistatic::backward` gives, is bracketed and found on all of them.
///
/// Per vertex, with x = log μ `[V]`: L-BFGS from the global μ on
///
///     Σ |r*(x) − r_T|² / Σ |r*(reference) − r_T|²  +  ½ w Σ_e c_e (x_a − x_b)²
///
/// The sum is the Dirichlet energy of log μ on a mesh of regular triangles (c = 1/√3, half of it at a boundary): it
/// does not depend on the mesh's size or resolution, so neither does w. The weights are tried from stiff to soft, each
/// from the result of the one before, for as long as the validation error falls; the best on validation is chosen.
/// Without validation samples every fourth train sample is held out for this choice.
///
/// Each projection starts at its prediction, so an error given here is the one that `toile project` would make. A
/// sample whose projection has no derivative counts in no derivative. The result depends on the samples, the options
/// and the seed, not on `jobs`. Throws Error for options out of range and where there are no train samples.
MuFit fit_mu(const ClothMesh& mesh, const MuSamples& train, const MuSamples& validation, const MuFitOptions& options);

}  // namespace toile::evaluate

#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "prior/quasistatic.h"

namespace toile::evaluate {

/// Cloth of some samples side by side, contiguous by sample.
struct ClothPairs {
    std::vector<double> predicted;  ///< `[N x V x 3]` r̂ [m]
    std::vector<double> target;     ///< `[N x V x 3]` r_T [m]
};

/// How far the quasistatic prior's results are from the truth, as a function of x = log μ `[V]`:
///
///     mean over samples and vertices of |r*(x) − r_T|²
///
/// Each projection starts at its prediction, so that the value depends on x alone and not on what was asked before.
class MuLoss {
  public:
    struct Value {
        double squared_error = 0;  ///< [m²]
        Eigen::VectorXd gradient;  ///< `[V]` by x; empty unless it was asked for
        int left_out = 0;          ///< samples without derivative, which the gradient leaves out
    };

    /// `model`'s μ does not matter. Throws Error where the pairs do not fit it.
    MuLoss(prior::QuasistaticModel model, double tolerance, ClothPairs pairs, int jobs);

    int sample_count() const { return samples_; }
    int vertex_count() const { return prior_.model().vertex_count; }
    /// A sample has a derivative where its projection reached its accuracy and the energy's Hessian is positive
    /// definite there (prior::DerivativeReport).
    Value operator()(const Eigen::VectorXd& log_mu, bool with_gradient = true);
    /// Of the predictions themselves [m²]; NaN without samples.
    double predicted_squared_error() const;
    /// The first `count` of the samples spread evenly over all.
    ClothPairs some(int count) const;

  private:
    void add_gradient(Value& value);

    prior::Quasistatic prior_;
    prior::Quasistatic::Workspace workspace_;
    ClothPairs pairs_;
    int samples_ = 0;
    prior::QuasistaticSolution solution_;
    prior::QuasistaticGradient gradient_;
    std::vector<double> loss_gradient_;
};

}  // namespace toile::evaluate

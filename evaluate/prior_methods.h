#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prior/inextensibility.h"
#include "prior/quasistatic.h"

namespace toile::evaluate {

/// What is done to a prediction before it is judged.
struct PriorMethod {
    enum class Kind { predicted, inextensibility, quasistatic };
    Kind kind = Kind::predicted;
    std::string name = "predicted";  ///< "inextensibility@limit=0.05", "quasistatic@mu=0.1", "quasistatic@mu=best"
    std::string title = "the prediction";  ///< for who looks at it
    double setting = 0;                    ///< the limit ε or μ; of μ per vertex the geometric mean
    Eigen::VectorXd mu;                    ///< `[V]` of the quasistatic prior

    static PriorMethod inextensibility(double limit);
    /// `label` takes the number's place in the name: "best".
    static PriorMethod quasistatic(double mu, int vertex_count, const std::string& label = {});
    static PriorMethod quasistatic_vertex(const Eigen::VectorXd& mu);
};

/// Cloths of several samples after a method.
struct MethodResult {
    std::vector<double> position;       ///< `[N x V x 3]` [m]
    std::vector<prior::Report> report;  ///< `[N]`; empty for the prediction itself
};

/// Puts batches of one mesh through both priors, one batch at a time. A sample's result depends on neither its
/// neighbours nor `threads`, but a batch of one takes another path than larger ones (prior/inextensibility.h).
class PriorRunner {
  public:
    PriorRunner(const ClothMesh& mesh, int threads, const std::string& where = {});
    ~PriorRunner();

    /// `predicted` `[N x V x 3]` [m].
    MethodResult run(const PriorMethod& method, std::span<const double> predicted);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Samples that follow each other in one batch of at most `size`: never leaves a single one for last.
int next_batch(int left, int size);

}  // namespace toile::evaluate

#pragma once

#include <vector>

#include "prior/incomplete_cholesky.h"
#include "prior/linear_sweeps.h"
#include "prior/spring_graph.h"

namespace toile::prior {

/// `SingleSweeps` for one sample alone: a vertex' three numbers go side by side through the processor, as there are no
/// other samples to.
class OneSampleSweeps final : public LinearSweeps<1> {
  public:
    explicit OneSampleSweeps(const SpringGraph& graph);

    void linearize(const double* position, const double* exact, const double* exact_factor) override;
    void factor(const double* exact_factor, double* lost_pivot) override;
    void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) override;
    void multiply(double* q_dot_y) override;
    void advance(const double* length, double* r_squared, double* r_largest) override;
    void condition(double* r_dot_z) override;
    void turn(const double* turn) override;
    void read(double* d) const override;

    /// Three numbers of a vertex, and a fourth without meaning.
    struct alignas(16) Quad {
        float number[4];
    };

  private:
    const SpringGraph& graph_;
    IncompleteCholesky<1> incomplete_;
    double scale_ = 1.0;
    LaneArray diagonal_;
    std::vector<SingleLanes<1>> form_;             // [S][4]
    std::vector<Quad> row_, column_;               // [S][3] of the factor's blocks
    std::vector<Quad> pivot_;                      // [V][3] columns of its inverse pivots
    std::vector<Quad> d_, r_, z_, q_, y_, w_, u_;  // [V]
};

}  // namespace toile::prior

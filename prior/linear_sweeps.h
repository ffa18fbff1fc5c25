#pragma once

#include <memory>
#include <vector>

#include "cloth/lane_array.h"
#include "prior/float_lanes.h"
#include "prior/incomplete_cholesky.h"
#include "prior/preconditioner.h"
#include "prior/spring_graph.h"

namespace toile::prior {

/// The vectors of preconditioned conjugate gradients for H d = b, of W samples side by side, and the loops over them:
///
///     begin      r = b, d = 0, q = z = P r
///     multiply   y = H q
///     advance    d += length q, r −= length y
///     condition  z = P r
///     turn       q = z + turn q
///
/// The method itself, which decides for each lane, is the caller's. Sums are in units of each lane's b.
template <int W>
class LinearSweeps {
  public:
    virtual ~LinearSweeps() = default;

    /// The Hessians at `position`, exact or projected by lane, for H and for what P is made of (prior/spring_lanes.h).
    virtual void linearize(const double* position, const double* exact, const double* exact_factor) = 0;
    /// Makes P. Lanes that were not positive definite have `lost_pivot` `[W]` above 0.
    virtual void factor(const double* exact_factor, double* lost_pivot) = 0;
    virtual void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) = 0;
    virtual void multiply(double* q_dot_y) = 0;
    virtual void advance(const double* length, double* r_squared, double* r_largest) = 0;
    virtual void condition(double* r_dot_z) = 0;
    virtual void turn(const double* turn) = 0;
    /// d, in the units of b.
    virtual void read(double* d) const = 0;
};

/// In double precision, with any preconditioner.
template <int W>
class DoubleSweeps final : public LinearSweeps<W> {
  public:
    DoubleSweeps(const SpringGraph& graph, std::unique_ptr<Preconditioner<W>> preconditioner);

    void linearize(const double* position, const double* exact, const double* exact_factor) override;
    void factor(const double* exact_factor, double* lost_pivot) override;
    void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) override;
    void multiply(double* q_dot_y) override;
    void advance(const double* length, double* r_squared, double* r_largest) override;
    void condition(double* r_dot_z) override;
    void turn(const double* turn) override;
    void read(double* d) const override;

  private:
    const SpringGraph& graph_;
    std::unique_ptr<Preconditioner<W>> preconditioner_;
    int size_;
    LaneArray form_, diagonal_, d_, r_, z_, q_, y_;
};

/// In single precision, with the incomplete factor, for half the memory traffic: good to about 1e-5 of b, which is
/// scaled to a largest entry of one.
template <int W>
class SingleSweeps final : public LinearSweeps<W> {
  public:
    explicit SingleSweeps(const SpringGraph& graph);

    void linearize(const double* position, const double* exact, const double* exact_factor) override;
    void factor(const double* exact_factor, double* lost_pivot) override;
    void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) override;
    void multiply(double* q_dot_y) override;
    void advance(const double* length, double* r_squared, double* r_largest) override;
    void condition(double* r_dot_z) override;
    void turn(const double* turn) override;
    void read(double* d) const override;

  private:
    const SpringGraph& graph_;
    IncompleteCholesky<W> preconditioner_;
    int size_;
    alignas(64) double scale_[W];
    LaneArray diagonal_;
    std::vector<SingleLanes<W>> form_, d_, r_, z_, q_, y_;
};

extern template class DoubleSweeps<1>;
extern template class DoubleSweeps<8>;
extern template class SingleSweeps<8>;

}  // namespace toile::prior

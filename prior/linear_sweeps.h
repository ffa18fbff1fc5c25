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

    /// The Hessians (prior/spring_lanes.h). The preconditioner is factored by its owner.
    virtual void set_system(const double* form) = 0;
    virtual void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) = 0;
    virtual void multiply(double* q_dot_y) = 0;
    virtual void advance(const double* length, double* r_squared, double* r_largest) = 0;
    virtual void condition(double* r_dot_z) = 0;
    virtual void turn(const double* turn) = 0;
    /// d, in the units of b.
    virtual void read(double* d) const = 0;
};

/// In double precision, with any preconditioner. `form` must stay where it is.
template <int W>
class DoubleSweeps final : public LinearSweeps<W> {
  public:
    DoubleSweeps(const SpringGraph& graph, Preconditioner<W>& preconditioner);

    void set_system(const double* form) override { form_ = form; }
    void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) override;
    void multiply(double* q_dot_y) override;
    void advance(const double* length, double* r_squared, double* r_largest) override;
    void condition(double* r_dot_z) override;
    void turn(const double* turn) override;
    void read(double* d) const override;

  private:
    const SpringGraph& graph_;
    Preconditioner<W>& preconditioner_;
    int size_;
    const double* form_ = nullptr;
    LaneArray d_, r_, z_, q_, y_;
};

/// In single precision, for half the memory traffic: good to about 1e-5 of b, which is scaled to a largest entry of
/// one.
template <int W>
class SingleSweeps final : public LinearSweeps<W> {
  public:
    SingleSweeps(const SpringGraph& graph, IncompleteCholesky<W>& preconditioner);

    void set_system(const double* form) override;
    void begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) override;
    void multiply(double* q_dot_y) override;
    void advance(const double* length, double* r_squared, double* r_largest) override;
    void condition(double* r_dot_z) override;
    void turn(const double* turn) override;
    void read(double* d) const override;

  private:
    const SpringGraph& graph_;
    IncompleteCholesky<W>& preconditioner_;
    int size_;
    alignas(64) double scale_[W];
    std::vector<SingleLanes<W>> form_, d_, r_, z_, q_, y_;
};

extern template class DoubleSweeps<1>;
extern template class DoubleSweeps<8>;
extern template class SingleSweeps<1>;
extern template class SingleSweeps<8>;

}  // namespace toile::prior

#pragma once

#include <array>
#include <memory>
#include <vector>

#include "cloth/lane_array.h"
#include "cloth/lane_cholesky.h"
#include "cloth/scalar_cholesky.h"
#include "prior/inextensibility.h"
#include "prior/inextensibility_kernels.h"

namespace toile::prior {

/// What all samples of one mesh share, in the units of `InextensibilityLanes`: built once, const afterwards.
struct InextensibilityShared {
    InextensibilityShared(const InextensibilityModel& model);
    /// New limits for the same graph.
    void scale(const InextensibilityModel& model);

    int vertex_count, edge_count;
    std::vector<int> edge;          ///< `[E][2]`
    std::vector<int> slot;          ///< `[E]`
    std::vector<double> limit;      ///< `[E]` in units of `length`
    std::vector<double> stiffness;  ///< `[V]` in units of `stiffness_scale`
    double length = 1;              ///< mean edge limit [m]
    double stiffness_scale = 1;     ///< mean k_i
    double penalty = 10;            ///< ρ of the first-order sweeps
    std::shared_ptr<const BlockSymbolic> symbolic;
    std::unique_ptr<const ScalarCholesky> constant;  ///< K + ρ GᵀG
};

/// The numeric storage of one group of W samples, for `project` and for the derivatives.
template <int W>
class InextensibilityBuffers {
  public:
    explicit InextensibilityBuffers(const InextensibilityShared& shared);

    const InextensibilityShared& shared;
    InextensibilityLanes<W> lanes;
    std::unique_ptr<LaneCholesky<W>> cholesky;
    /// Makes matrix and factor, if they are not there: most of the memory, and not all buffers need them.
    void make_matrix();
    std::array<std::array<double, 3>, W> origin{};  ///< of each lane's sample [m]

    /// Brings `[V x 3]` positions into a lane of `predicted`, relative to their mean, and keeps that as the lane's
    /// origin. False if a number is not finite: the lane is then zero.
    bool load_predicted(int lane, const double* position);
    /// Brings positions `[V x 3]` into a lane of `position`, relative to the lane's origin.
    void load_position(int lane, const double* position);
    void load_multiplier(int lane, const double* multiplier);
    void store_position(int lane, double* position) const;
    void store_multiplier(int lane, double* multiplier) const;

    /// Takes over a sample that is being solved: predicted, position, slack and multiplier of a lane.
    void take_lane(int lane, const InextensibilityBuffers& from, int from_lane);

  private:
    double* take(std::size_t doubles);
    std::vector<LaneArray> storage_;
};

extern template class InextensibilityBuffers<1>;
extern template class InextensibilityBuffers<8>;

}  // namespace toile::prior

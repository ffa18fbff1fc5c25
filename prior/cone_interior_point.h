#pragma once

#include <Eigen/Core>
#include <vector>

#include "prior/cone_kkt.h"
#include "prior/cone_program.h"
#include "prior/report.h"
#include "prior/second_order_cone.h"

namespace toile::prior {

/// A point of the interior-point method: strictly inside the cones, with s_e¹ = B_e (r̂ + u) at all times, so that every
/// iterate obeys the edge limits; what is left to reach is the balance of forces and s ∘ z = 0.
struct ConeIterate {
    Eigen::VectorXd u;   ///< `[3V]` r − r̂
    Eigen::Matrix4Xd s;  ///< `[4 x E]`
    Eigen::Matrix4Xd z;  ///< `[4 x E]`

    double mean_product() const { return s.cols() > 0 ? s.cwiseProduct(z).sum() / static_cast<double>(s.cols()) : 0; }
};

/// Primal-dual interior-point method for a `ConeProgram`: Nesterov-Todd scaling, Mehrotra's predictor and corrector,
/// one factorisation a step (as ECOS, the paper's [53], and Clarabel, which keeps the quadratic objective as we do). A
/// homogeneous embedding, which those need to detect infeasibility, would serve nothing: both sides have interior
/// points, and `start` finds one.
class ConeInteriorPoint {
  public:
    ConeInteriorPoint(const Edges& edge, int vertex_count);

    /// The equilibrium of an elastic cloth whose springs have no rest length and pull with one force f at their edge's
    /// limit: stiff enough, they hold every edge well below it, and with z_e = f (1, −s_e¹ / l_e^max) forces balance
    /// exactly and each cone is well centred, however much the limits differ. False if the numbers overflow.
    bool start(const ConeProgram& program, ConeIterate& iterate, Report& report);
    /// One step. False if it could not make progress.
    bool step(const ConeProgram& program, ConeIterate& iterate, Report& report);

    ConeKkt& kkt() { return kkt_; }

  private:
    void assemble(const ConeProgram& program, const ConeIterate& iterate);
    void direction(const ConeProgram& program, const ConeIterate& iterate, const Eigen::Matrix4Xd& scaled_right);
    double longest_step(const ConeIterate& iterate) const;
    double predictor(const ConeProgram& program, const ConeIterate& iterate);
    void corrector(const ConeProgram& program, const ConeIterate& iterate, double affine_step);

    ConeKkt kkt_;
    std::vector<ConeScaling> scaling_;
    Eigen::Matrix4Xd lambda_;        // W z = W⁻¹ s
    Eigen::Matrix4Xd right_scaled_;  // of  W dz + W⁻¹ ds = c
    Eigen::VectorXd imbalance_;      // `[3V]` K u − Σ B_eᵀ z_e¹
    Eigen::VectorXd right_, solution_;
    Eigen::VectorXd du_;
    Eigen::Matrix4Xd ds_, dz_;
};

}  // namespace toile::prior

#pragma once

#include <functional>

#include "cloth/types.h"

namespace toile::simulate {

/// Steps of a minimiser that knows a positive definite matrix P, factored, and the product with the true Hessian H,
/// which may be indefinite: conjugate gradients, preconditioned with P, on the quadratic model g·d + ½ d·H d, ended at
/// the rim of the region |d|_P <= radius or where H curves downwards (Steihaug 1983; Nocedal and Wright, Algorithm
/// 7.2). The first iterate is Newton's step with P, lengthened or shortened; each further one costs a solve. The radius
/// follows how well the model foretold the decrease.
class TrustRegion {
  public:
    /// Output from input, both `[V x 3]`.
    using Operator = std::function<void(const Positions& in, Positions& out)>;

    /// Forgets the radius: the next step sets it.
    void reset() { radius_ = 0.0; }

    /// `direction` `[V x 3]` holds -P⁻¹ g before and the step after; `multiply` applies H, `precondition` P⁻¹.
    void improve(const Positions& gradient, const Operator& multiply, const Operator& precondition,
                 Positions& direction);
    /// What came of the last step: the share of it that was taken, and by how much the objective fell.
    void learn(double share, double decrease);

    double radius() const { return radius_; }      ///< in the norm of P
    double length() const { return length_; }      ///< of the last step, in the norm of P
    double decrease() const { return decrease_; }  ///< what the model foretold for it
    bool at_rim() const { return at_rim_; }        ///< whether the last step ended there

  private:
    double radius_ = 0.0, length_ = 0.0, decrease_ = 0.0;
    bool at_rim_ = false;
    Positions residual_, preconditioned_, way_, product_;
};

}  // namespace toile::simulate

#pragma once

#include <Eigen/Core>
#include <vector>

namespace toile::evaluate {

/// A time derivative at one frame as a sum over frames, and a second one of the same order that tells its error.
struct RateStencil {
    struct Term {
        int frame = 0;
        double weight = 0;  ///< divided by the time step
    };
    std::vector<Term> rate;
    std::vector<Term> check;  ///< empty: too few frames for one
    double error_share = 0;   ///< the rate's own error is this share of the difference of the two (Richardson)
};

/// Central differences over steps of h, checked by those of 2h; at the ends of second order to one side; of two frames
/// the first order there is. Error estimates from five frames on (away from the ends, from four).
RateStencil rate_stencil(int frame, int frame_count);

/// How the surface moves at one triangle or vertex: L = dF/dt F^-1 = D + W.
struct StrainRate {
    Eigen::Matrix3d velocity_gradient;  ///< L [1/s]; its symmetric part is D, the skew one W
    Eigen::Vector2d rate;               ///< principal strain rates in the tangent plane, the larger first [1/s]
    Eigen::Vector3d spin;               ///< w, with W x = w cross x [rad/s]
    double error = 0;  ///< the time step's, Frobenius norm of L's [1/s]; NaN where there is no estimate

    bool is_finite() const { return velocity_gradient.allFinite() && rate.allFinite() && spin.allFinite(); }
};

/// `gradient` holds F of the window's frames, the first being `first_frame`; `normal` is the rest normal. NaN where F
/// is not there in a frame of the stencil, or cannot be inverted (determinant below 1e-10 of |F|^3).
StrainRate strain_rate(const RateStencil& stencil, int frame, int first_frame,
                       const std::vector<Eigen::Matrix3d>& gradient, const Eigen::Vector3d& normal, double time_step);

}  // namespace toile::evaluate

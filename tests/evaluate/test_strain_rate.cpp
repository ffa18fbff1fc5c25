#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "evaluate/strain_rate.h"

namespace toile::evaluate {
namespace {

using Motion = std::function<Eigen::Matrix3d(double)>;
const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();

StrainRate rate_at(const Motion& motion, int frame, int count, double step, double start = 0.1) {
    const int first = std::max(0, std::min(frame - 2, count - 5)), last = std::min(count, first + 5);
    std::vector<Eigen::Matrix3d> gradient;
    for (int k = first; k < last; ++k) gradient.push_back(motion(start + step * k));
    return strain_rate(rate_stencil(frame, count), frame, first, gradient, up, step);
}

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
    Eigen::Matrix3d out;
    out << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return out;
}

const Eigen::Vector3d spin(0.4, -1.0, 0.7);
Eigen::Matrix3d spinning(double t) {
    return Eigen::AngleAxisd(spin.norm() * t, spin.normalized()).toRotationMatrix();
}
Eigen::Matrix3d stretching(double t) {
    return Eigen::Vector3d(std::exp(0.8 * t), std::exp(-0.5 * t), 1).asDiagonal();
}
/// L = dR/dt R^T + R (dS/dt S^-1) R^T.
Eigen::Matrix3d mixed_velocity(double t) {
    const Eigen::Matrix3d d = Eigen::Vector3d(0.8, -0.5, 0).asDiagonal();
    return skew(spin) + spinning(t) * d * spinning(t).transpose();
}

TEST(StrainRate, IsExactForMotionsOfSecondDegree) {
    // F quadratic in time: every stencil of second order is exact.
    const Motion motion = [](double t) {
        Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
        f(0, 0) = 1 + 0.3 * t + 0.2 * t * t;
        f(0, 1) = 0.5 * t * t;
        f(1, 1) = 1 - 0.1 * t;
        return f;
    };
    for (int frame = 0; frame < 7; ++frame) {
        const double t = 0.1 + 0.05 * frame;
        Eigen::Matrix3d speed = Eigen::Matrix3d::Zero();
        speed(0, 0) = 0.3 + 0.4 * t;
        speed(0, 1) = t;
        speed(1, 1) = -0.1;
        const StrainRate rate = rate_at(motion, frame, 7, 0.05);
        EXPECT_NEAR((rate.velocity_gradient - speed * motion(t).inverse()).norm(), 0, 1e-12) << frame;
        EXPECT_NEAR(rate.error, 0, 1e-12) << frame;
    }
}

TEST(StrainRate, TellsStillnessFromMotion) {
    const StrainRate rate = rate_at([](double) { return Eigen::Matrix3d(spinning(0.3) * 1.2); }, 3, 9, 0.01);
    EXPECT_NEAR(rate.velocity_gradient.norm(), 0, 1e-12);
    EXPECT_NEAR(rate.spin.norm() + rate.rate.norm() + rate.error, 0, 1e-12);
}

TEST(StrainRate, FindsSpinAndStretchRateApart) {
    const StrainRate turning = rate_at(spinning, 4, 9, 1e-3);
    EXPECT_NEAR((turning.spin - spin).norm(), 0, 2e-6);
    EXPECT_NEAR(turning.rate.norm(), 0, 1e-9);
    const StrainRate growing = rate_at(stretching, 4, 9, 1e-3);
    EXPECT_NEAR(growing.rate[0], 0.8, 1e-6);
    EXPECT_NEAR(growing.rate[1], -0.5, 1e-6);
    EXPECT_NEAR(growing.spin.norm(), 0, 1e-12);
    const StrainRate both = rate_at([](double t) { return Eigen::Matrix3d(spinning(t) * stretching(t)); }, 4, 9, 1e-3);
    EXPECT_NEAR((both.spin - spin).norm(), 0, 1e-5);
    EXPECT_NEAR(both.rate[0], 0.8, 1e-5);
    EXPECT_NEAR(both.rate[1], -0.5, 1e-5);
}

TEST(StrainRate, ConvergesWithTheSquareOfTheStepAndKnowsItsError) {
    const Motion motion = [](double t) { return Eigen::Matrix3d(spinning(t) * stretching(t)); };
    for (const int frame : {0, 1, 4, 7, 8}) {
        std::vector<double> error, estimate;
        for (const double step : {0.04, 0.02, 0.01, 0.005}) {
            const double start = 1 - frame * step;  // the same instant for all steps
            const StrainRate rate = rate_at(motion, frame, 9, step, start);
            error.push_back((rate.velocity_gradient - mixed_velocity(1)).norm());
            estimate.push_back(rate.error);
        }
        for (size_t k = 1; k < error.size(); ++k) EXPECT_NEAR(std::log2(error[k - 1] / error[k]), 2, 0.15) << frame;
        EXPECT_NEAR(estimate.back() / error.back(), 1, 0.05) << frame;
    }
}

TEST(StrainRate, KeepsSecondOrderAndItsErrorInShortSequences) {
    for (int count = 2; count <= 6; ++count) {
        for (int frame = 0; frame < count; ++frame) {
            const auto error = [&](double step) {
                const StrainRate rate = rate_at(stretching, frame, count, step, 1 - frame * step);
                EXPECT_EQ(std::isnan(rate.error), rate_stencil(frame, count).check.empty());
                return (rate.velocity_gradient - Eigen::Matrix3d(Eigen::Vector3d(0.8, -0.5, 0).asDiagonal())).norm();
            };
            EXPECT_NEAR(std::log2(error(0.02) / error(0.01)), count == 2 ? 1 : 2, 0.1) << frame << " of " << count;
        }
    }
}

TEST(StrainRate, IsNotThereWhereTheGradientIsNot) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Motion hole = [nan](double t) {
        return t > 0.135 && t < 0.145 ? Eigen::Matrix3d(Eigen::Matrix3d::Constant(nan)) : stretching(t);
    };
    EXPECT_FALSE(rate_at(hole, 3, 9, 0.01).is_finite());  // frame 4 is missing
    EXPECT_FALSE(rate_at(hole, 4, 9, 0.01).is_finite());
    EXPECT_TRUE(rate_at(hole, 6, 9, 0.01).is_finite());
    EXPECT_TRUE(std::isnan(rate_at(hole, 6, 9, 0.01).error)) << "its check needs frame 4";
    const Motion flattened = [](double) { return Eigen::Matrix3d(Eigen::Vector3d(1, 0, 1).asDiagonal()); };
    EXPECT_FALSE(rate_at(flattened, 3, 9, 0.01).is_finite());
}

}  // namespace
}  // namespace toile::evaluate

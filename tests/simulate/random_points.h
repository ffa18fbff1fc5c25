#pragma once

#include <Eigen/Geometry>
#include <random>

#include "simulate/proximity.h"

namespace toile::test {

/// Points for tests of contact geometry, the same for the same seed: general ones, and all ways to be degenerate.
class RandomPoints {
  public:
    explicit RandomPoints(unsigned seed) : engine_(seed) {}

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    int whole(int below) { return std::uniform_int_distribution<int>(0, below - 1)(engine_); }
    Eigen::Vector3d point(double size = 1.0) { return {number(-size, size), number(-size, size), number(-size, size)}; }

    /// Four points whose shape depends on `kind`.
    static constexpr int kinds = 8;
    simulate::FourPoints four(int kind) {
        simulate::FourPoints x = {point(), point(), point(), point()};
        switch (kind) {
            case 1:  // coplanar
                for (auto& p : x) p[2] = 0.25;
                break;
            case 2:  // second feature without length or area
                x[3] = x[2];
                break;
            case 3:  // parallel edges
                x[3] = x[2] + number(-2.0, 2.0) * (x[1] - x[0]);
                break;
            case 4:  // nearly parallel edges
                x[3] = x[2] + number(-2.0, 2.0) * (x[1] - x[0]) + point(1e-9);
                break;
            case 5:  // triangle on one line
                x[3] = x[1] + number(-2.0, 2.0) * (x[2] - x[1]);
                break;
            case 6:  // triangle a thousand times as long as high
                x[3] = x[1] + number(-2.0, 2.0) * (x[2] - x[1]) + point(1e-3);
                break;
            case 7:  // points only
                x[1] = x[0];
                x[3] = x[2];
                break;
            default:
                break;
        }
        return x;
    }

  private:
    std::mt19937 engine_;
};

}  // namespace toile::test

#pragma once

namespace toile::prior {

/// Loops over vectors of W samples side by side (cloth/lane.h): arrays `[size][W]`, numbers of one lane `[W]`, all
/// aligned to `lane_alignment<W>`.
template <int W>
struct VectorLanes {
    static void dot(int size, const double* x, const double* y, double* sum);
    static void largest(int size, const double* x, double* result);
    /// x *= a.
    static void scale(int size, const double* a, double* x);
    /// z = x − y.
    static void difference(int size, const double* x, const double* y, double* z);
    /// Where a > 0: x = 0 and r = b.
    static void restart(int size, const double* a, const double* b, double* x, double* r);
    /// x += a p, r −= a y; gives r·r and the largest |r|.
    static void advance(int size, const double* a, const double* p, const double* y, double* x, double* r,
                        double* r_squared, double* r_largest);
    /// q = z + b q.
    static void turn(int size, const double* b, const double* z, double* q);
    /// trial = x − s d as it would be stored, rounded like (trial + origin) − origin with `origin` `[3][W]`; size is a
    /// multiple of three. No step where s = 0, whatever d. Gives g·d.
    static void step(int size, const double* s, const double* x, const double* d, const double* g, const double* origin,
                     double* trial, double* g_dot_d);
};

extern template struct VectorLanes<1>;
extern template struct VectorLanes<8>;

}  // namespace toile::prior

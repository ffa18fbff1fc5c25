#pragma once

namespace toile::prior {

/// Loops over vectors of W samples side by side (cloth/lane.h): arrays `[size][W]`, numbers of one lane `[W]`, all
/// aligned to `lane_alignment<W>`. Instantiated for W = 1 and 8.

template <int W>
void dot_lanes(int size, const double* x, const double* y, double* sum);
template <int W>
void largest_in_lanes(int size, const double* x, double* result);
/// x *= a.
template <int W>
void scale_lanes(int size, const double* a, double* x);
/// z = x − y.
template <int W>
void subtract_lanes(int size, const double* x, const double* y, double* z);
/// y += a x; y stays as it is where a = 0, whatever x.
template <int W>
void add_lanes(int size, const double* a, const double* x, double* y);
/// x += a p, r −= a y; gives r·r and the largest |r|.
template <int W>
void advance_lanes(int size, const double* a, const double* p, const double* y, double* x, double* r, double* r_squared,
                   double* r_largest);
/// q = z + b q.
template <int W>
void turn_lanes(int size, const double* b, const double* z, double* q);
/// trial = x − s d as it would be stored, rounded like (trial + origin) − origin with `origin` `[3][W]`; size is a
/// multiple of three. No step where s = 0, whatever d. Gives g·d.
template <int W>
void step_lanes(int size, const double* s, const double* x, const double* d, const double* g, const double* origin,
                double* trial, double* g_dot_d);

}  // namespace toile::prior

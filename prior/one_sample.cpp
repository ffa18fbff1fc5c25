#include "prior/one_sample.h"

#include <algorithm>
#include <cmath>

#include "cloth/lane.h"
#include "prior/spring_lanes.h"

namespace toile::prior {
namespace {

using Quad = OneSampleSweeps::Quad;
using Four = float __attribute__((vector_size(16), may_alias));

[[gnu::always_inline]] inline Four load(const Quad* p) {
    return *reinterpret_cast<const Four*>(p->number);
}
[[gnu::always_inline]] inline void store(Quad* p, Four x) {
    *reinterpret_cast<Four*>(p->number) = x;
}
[[gnu::always_inline]] inline float dot(Four a, Four b) {
    const Four p = a * b;
    return p[0] + p[1] + p[2];
}
[[gnu::always_inline]] inline Four load_form(const SingleLanes<1>* p) {
    using Unaligned = float __attribute__((vector_size(16), may_alias, aligned(4)));
    return *reinterpret_cast<const Unaligned*>(p->lane);
}
/// The matrix with these columns, times v.
[[gnu::always_inline]] inline Four times(const Quad* column, Four v) {
    return load(column) * v[0] + load(column + 1) * v[1] + load(column + 2) * v[2];
}

TOILE_LANE_KERNEL double multiply_one(const SpringGraph& graph, const SingleLanes<1>* form, const Quad* x,
                                      Quad* product) {
    double sum = 0.0;
    for (int a = 0; a < graph.vertex_count; ++a) store(product + a, Four{});
    for (int a = 0; a < graph.vertex_count; ++a) {
        const Four v = load(x + a);
        Four y = load(product + a) + static_cast<float>(graph.target[a]) * v;
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) {
            const int b = graph.spring[s].other;
            const Four m = load_form(form + 4 * s), d = v - load(x + b), f = m[3] * d + dot(m, d) * m;
            y += f;
            store(product + b, load(product + b) - f);
        }
        store(product + a, y);
        sum += dot(v, y);
    }
    return sum;
}

TOILE_LANE_KERNEL void solve_forward_one(const SpringGraph& graph, const Quad* column, const Quad* pivot, const Quad* r,
                                         Quad* w, Quad* u) {
    for (int i = 0; i < graph.vertex_count; ++i) {
        Four s = load(r + i);
        for (int e = graph.row_first[i]; e < graph.row_first[i + 1]; ++e)
            s -= times(column + 3 * e, load(w + graph.entry[e].column));
        store(u + i, s);
        store(w + i, times(pivot + 3 * i, s));
    }
}

TOILE_LANE_KERNEL double solve_backward_one(const SpringGraph& graph, const Quad* row, const Quad* pivot, const Quad* r,
                                            Quad* z, Quad* u) {
    double sum = 0.0;
    for (int i = graph.vertex_count - 1; i >= 0; --i) {
        const Four x = times(pivot + 3 * i, load(u + i));
        store(z + i, x);
        sum += dot(x, load(r + i));
        for (int e = graph.row_first[i + 1] - 1; e >= graph.row_first[i]; --e) {
            Quad* out = u + graph.entry[e].column;
            store(out, load(out) - times(row + 3 * e, x));
        }
    }
    return sum;
}

TOILE_LANE_KERNEL void advance_one(size_t count, float length, const Quad* q, const Quad* y, Quad* d, Quad* r,
                                   double* r_squared, double* r_largest) {
    double sum = 0.0;
    Four most{};
    for (size_t i = 0; i < count; ++i) {
        store(d + i, load(d + i) + length * load(q + i));
        const Four rest = load(r + i) - length * load(y + i);
        store(r + i, rest);
        sum += dot(rest, rest);
        const Four size = rest < 0.0f ? -rest : rest;
        most = size > most ? size : most;
    }
    *r_squared = sum;
    *r_largest = std::max({most[0], most[1], most[2]});
}

TOILE_LANE_KERNEL void turn_one(size_t count, float turn, const Quad* z, Quad* q) {
    for (size_t i = 0; i < count; ++i) store(q + i, load(z + i) + turn * load(q + i));
}

}  // namespace

OneSampleSweeps::OneSampleSweeps(const SpringGraph& graph)
    : graph_(graph),
      incomplete_(graph),
      diagonal_(6 * static_cast<size_t>(graph.vertex_count)),
      form_(4 * graph.spring.size()),
      row_(3 * graph.spring.size()),
      column_(3 * graph.spring.size()),
      pivot_(3 * static_cast<size_t>(graph.vertex_count)) {
    for (std::vector<Quad>* vector : {&d_, &r_, &z_, &q_, &y_, &w_, &u_})
        vector->resize(static_cast<size_t>(graph.vertex_count));
}

void OneSampleSweeps::linearize(const double* position, const double* exact, const double* exact_factor) {
    linearize_springs<1>(graph_, position, exact, exact_factor, form_.data(), diagonal_.data());
}

void OneSampleSweeps::factor(const double* exact_factor, double* lost_pivot) {
    incomplete_.factor_single(form_.data(), diagonal_.data(), exact_factor, lost_pivot);
    const SingleLanes<1>* lower = incomplete_.lower();
    for (size_t e = 0; e < graph_.entry.size(); ++e, lower += 9)
        for (size_t k = 0; k < 3; ++k) {
            row_[3 * e + k] = {{lower[3 * k].lane[0], lower[3 * k + 1].lane[0], lower[3 * k + 2].lane[0], 0.0f}};
            column_[3 * e + k] = {{lower[k].lane[0], lower[3 + k].lane[0], lower[6 + k].lane[0], 0.0f}};
        }
    const SingleLanes<1>* pivot = incomplete_.pivot();
    for (size_t v = 0; v < pivot_.size() / 3; ++v, pivot += 6) {
        const float xx = pivot[0].lane[0], yx = pivot[1].lane[0], yy = pivot[2].lane[0];
        const float zx = pivot[3].lane[0], zy = pivot[4].lane[0], zz = pivot[5].lane[0];
        pivot_[3 * v] = {{xx, yx, zx, 0.0f}};
        pivot_[3 * v + 1] = {{yx, yy, zy, 0.0f}};
        pivot_[3 * v + 2] = {{zx, zy, zz, 0.0f}};
    }
}

void OneSampleSweeps::begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) {
    scale_ = 0.0;
    for (size_t i = 0; i < 3 * r_.size(); ++i) scale_ = std::max(scale_, std::abs(b[i]));
    *r_largest = scale_ > 0.0 ? 1.0 : 0.0;
    if (!(scale_ > 0.0)) scale_ = 1.0;
    *r_squared = 0.0;
    for (size_t v = 0; v < r_.size(); ++v)
        for (size_t c = 0; c < 3; ++c) {
            const double x = b[3 * v + c] / scale_;
            r_[v].number[c] = static_cast<float>(x);
            *r_squared += x * x;
        }
    std::fill(d_.begin(), d_.end(), Quad{});
    condition(r_dot_z);
    std::copy(z_.begin(), z_.end(), q_.begin());
}

void OneSampleSweeps::multiply(double* q_dot_y) {
    *q_dot_y = multiply_one(graph_, form_.data(), q_.data(), y_.data());
}

void OneSampleSweeps::advance(const double* length, double* r_squared, double* r_largest) {
    advance_one(d_.size(), static_cast<float>(*length), q_.data(), y_.data(), d_.data(), r_.data(), r_squared,
                r_largest);
}

void OneSampleSweeps::condition(double* r_dot_z) {
    solve_forward_one(graph_, column_.data(), pivot_.data(), r_.data(), w_.data(), u_.data());
    *r_dot_z = solve_backward_one(graph_, row_.data(), pivot_.data(), r_.data(), z_.data(), u_.data());
}

void OneSampleSweeps::turn(const double* turn) {
    turn_one(d_.size(), static_cast<float>(*turn), z_.data(), q_.data());
}

void OneSampleSweeps::read(double* d) const {
    for (size_t v = 0; v < d_.size(); ++v)
        for (size_t c = 0; c < 3; ++c) d[3 * v + c] = scale_ * static_cast<double>(d_[v].number[c]);
}

}  // namespace toile::prior

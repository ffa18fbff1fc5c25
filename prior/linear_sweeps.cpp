#include "prior/linear_sweeps.h"

#include <algorithm>

#include "prior/lane_vector.h"
#include "prior/spring_lanes.h"
#include "prior/vector_lanes.h"

namespace toile::prior {
namespace {

template <int W>
TOILE_LANE_KERNEL void narrow_lanes(int size, const double* factor, const double* from, SingleLanes<W>* to,
                                    double* squared) {
    const Lane<W> f = load_lanes<W>(factor);
    Lane<W> sum = lane_broadcast<W>(0.0);
    for (int i = 0; i < size; ++i) {
        const Lane<W> x = f * load_lanes<W>(from + W * i);
        store_floats<W>(to + i, narrow<W>(x));
        sum += x * x;
    }
    store_lanes<W>(squared, sum);
}

template <int W>
TOILE_LANE_KERNEL void widen_lanes(int size, const double* factor, const SingleLanes<W>* from, double* to) {
    const Lane<W> f = load_lanes<W>(factor);
    for (int i = 0; i < size; ++i) store_lanes<W>(to + W * i, f * widen<W>(load_floats<W>(from + i)));
}

template <int W>
TOILE_LANE_KERNEL void multiply_single(const SpringGraph& graph, const SingleLanes<W>* form, const SingleLanes<W>* x,
                                       SingleLanes<W>* product, double* x_dot_product) {
    const int vertices = graph.vertex_count;
    const int* first = graph.first.data();
    const SpringGraph::Spring* spring = graph.spring.data();
    Lane<W> sum = lane_broadcast<W>(0.0);
    const Floats<W> zero = narrow<W>(sum);
    for (int i = 0; i < 3 * vertices; ++i) store_floats<W>(product + i, zero);
    for (int a = 0; a < vertices; ++a) {
        const FloatVector<W> v = load_float_vector<W>(x + 3 * a);
        FloatVector<W> y = load_float_vector<W>(product + 3 * a);
        const float z = static_cast<float>(graph.target[a]);
        y = {y.x + z * v.x, y.y + z * v.y, y.z + z * v.z};
        for (int s = first[a]; s < first[a + 1]; ++s) {
            const int b = spring[s].other;
            const FloatVector<W> end = load_float_vector<W>(x + 3 * b), m = load_float_vector<W>(form + 4 * s);
            const FloatVector<W> d{v.x - end.x, v.y - end.y, v.z - end.z};
            const Floats<W> t = load_floats<W>(form + 4 * s + 3), along = dot<W>(m, d);
            const FloatVector<W> f{t * d.x + along * m.x, t * d.y + along * m.y, t * d.z + along * m.z};
            y = {y.x + f.x, y.y + f.y, y.z + f.z};
            const FloatVector<W> other = load_float_vector<W>(product + 3 * b);
            store_float_vector<W>(product + 3 * b, {other.x - f.x, other.y - f.y, other.z - f.z});
        }
        store_float_vector<W>(product + 3 * a, y);
        sum += widen<W>(dot<W>(v, y));
    }
    store_lanes<W>(x_dot_product, sum);
}

template <int W>
TOILE_LANE_KERNEL void advance_single(int size, const double* length, const SingleLanes<W>* q, const SingleLanes<W>* y,
                                      SingleLanes<W>* d, SingleLanes<W>* r, double* r_squared, double* r_largest) {
    const Floats<W> a = narrow<W>(load_lanes<W>(length));
    Lane<W> sum = lane_broadcast<W>(0.0), most = sum;
    for (int i = 0; i < size; ++i) {
        store_floats<W>(d + i, load_floats<W>(d + i) + a * load_floats<W>(q + i));
        const Floats<W> rest = load_floats<W>(r + i) - a * load_floats<W>(y + i);
        store_floats<W>(r + i, rest);
        const Lane<W> wide = widen<W>(rest);
        sum += wide * wide;
        most = lane_max(most, lane_abs(wide));
    }
    store_lanes<W>(r_squared, sum);
    store_lanes<W>(r_largest, most);
}

template <int W>
TOILE_LANE_KERNEL void turn_single(int size, const double* turn, const SingleLanes<W>* z, SingleLanes<W>* q) {
    const Floats<W> factor = narrow<W>(load_lanes<W>(turn));
    for (int i = 0; i < size; ++i) store_floats<W>(q + i, load_floats<W>(z + i) + factor * load_floats<W>(q + i));
}

}  // namespace

template <int W>
DoubleSweeps<W>::DoubleSweeps(const SpringGraph& graph, std::unique_ptr<Preconditioner<W>> preconditioner)
    : graph_(graph),
      preconditioner_(std::move(preconditioner)),
      size_(3 * graph.vertex_count),
      form_(4 * W * graph.spring.size()),
      diagonal_(6 * W * static_cast<size_t>(graph.vertex_count)) {
    for (LaneArray* vector : {&d_, &r_, &z_, &q_, &y_}) *vector = LaneArray(static_cast<size_t>(size_) * W);
}

template <int W>
void DoubleSweeps<W>::linearize(const double* position, const double* exact, const double* exact_factor) {
    linearize_springs<W>(graph_, position, exact, exact_factor, form_.data(), diagonal_.data());
}

template <int W>
void DoubleSweeps<W>::factor(const double* exact_factor, double* lost_pivot) {
    preconditioner_->factor(form_.data(), diagonal_.data(), exact_factor, lost_pivot);
}

template <int W>
void DoubleSweeps<W>::begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) {
    std::copy_n(b, r_.size(), r_.data());
    std::fill_n(d_.data(), d_.size(), 0.0);
    preconditioner_->solve(r_.data(), z_.data(), r_dot_z);
    std::copy_n(z_.data(), z_.size(), q_.data());
    dot_lanes<W>(size_, r_.data(), r_.data(), r_squared);
    largest_in_lanes<W>(size_, b, r_largest);
}

template <int W>
void DoubleSweeps<W>::multiply(double* q_dot_y) {
    alignas(64) double q_squared[W];
    multiply_springs<W>(graph_, form_.data(), q_.data(), y_.data(), q_dot_y, q_squared);
}

template <int W>
void DoubleSweeps<W>::advance(const double* length, double* r_squared, double* r_largest) {
    advance_lanes<W>(size_, length, q_.data(), y_.data(), d_.data(), r_.data(), r_squared, r_largest);
}

template <int W>
void DoubleSweeps<W>::condition(double* r_dot_z) {
    preconditioner_->solve(r_.data(), z_.data(), r_dot_z);
}

template <int W>
void DoubleSweeps<W>::turn(const double* turn) {
    turn_lanes<W>(size_, turn, z_.data(), q_.data());
}

template <int W>
void DoubleSweeps<W>::read(double* d) const {
    std::copy_n(d_.data(), d_.size(), d);
}

template <int W>
SingleSweeps<W>::SingleSweeps(const SpringGraph& graph)
    : graph_(graph),
      preconditioner_(graph),
      size_(3 * graph.vertex_count),
      diagonal_(6 * W * static_cast<size_t>(graph.vertex_count)),
      form_(4 * graph.spring.size()) {
    for (std::vector<SingleLanes<W>>* vector : {&d_, &r_, &z_, &q_, &y_}) vector->resize(static_cast<size_t>(size_));
}

template <int W>
void SingleSweeps<W>::linearize(const double* position, const double* exact, const double* exact_factor) {
    linearize_springs<W>(graph_, position, exact, exact_factor, form_.data(), diagonal_.data());
}

template <int W>
void SingleSweeps<W>::factor(const double* exact_factor, double* lost_pivot) {
    preconditioner_.factor_single(form_.data(), diagonal_.data(), exact_factor, lost_pivot);
}

template <int W>
void SingleSweeps<W>::begin(const double* b, double* r_dot_z, double* r_squared, double* r_largest) {
    alignas(64) double inverse[W];
    largest_in_lanes<W>(size_, b, scale_);
    for (int l = 0; l < W; ++l) {
        r_largest[l] = scale_[l] > 0.0 ? 1.0 : 0.0;
        if (!(scale_[l] > 0.0)) scale_[l] = 1.0;
        inverse[l] = 1.0 / scale_[l];
    }
    narrow_lanes<W>(size_, inverse, b, r_.data(), r_squared);
    std::fill(d_.begin(), d_.end(), SingleLanes<W>{});
    preconditioner_.solve_single(r_.data(), z_.data(), r_dot_z);
    std::copy(z_.begin(), z_.end(), q_.begin());
}

template <int W>
void SingleSweeps<W>::multiply(double* q_dot_y) {
    multiply_single<W>(graph_, form_.data(), q_.data(), y_.data(), q_dot_y);
}

template <int W>
void SingleSweeps<W>::advance(const double* length, double* r_squared, double* r_largest) {
    advance_single<W>(size_, length, q_.data(), y_.data(), d_.data(), r_.data(), r_squared, r_largest);
}

template <int W>
void SingleSweeps<W>::condition(double* r_dot_z) {
    preconditioner_.solve_single(r_.data(), z_.data(), r_dot_z);
}

template <int W>
void SingleSweeps<W>::turn(const double* turn) {
    turn_single<W>(size_, turn, z_.data(), q_.data());
}

template <int W>
void SingleSweeps<W>::read(double* d) const {
    widen_lanes<W>(size_, scale_, d_.data(), d);
}

template class DoubleSweeps<1>;
template class DoubleSweeps<8>;
template class SingleSweeps<8>;

}  // namespace toile::prior

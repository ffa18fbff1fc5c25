#include "prior/spring_lanes.h"

#include "prior/float_lanes.h"
#include "prior/lane_vector.h"

namespace toile::prior {
namespace {

template <int W>
[[gnu::always_inline]] inline void add_to(double* p, const Lane<W>& f, const LaneVector<W>& v) {
    store_lanes<W>(p, load_lanes<W>(p) + f * v.x);
    store_lanes<W>(p + W, load_lanes<W>(p + W) + f * v.y);
    store_lanes<W>(p + 2 * W, load_lanes<W>(p + 2 * W) + f * v.z);
}

/// 1 / length, or 0 for none.
template <int W>
[[gnu::always_inline]] inline Lane<W> inverse_length(const Lane<W>& length) {
    const Lane<W> zero = lane_broadcast<W>(0.0), one = lane_broadcast<W>(1.0);
    return lane_select(lane_less(zero, length), one / lane_select(lane_less(zero, length), length, one), zero);
}

}  // namespace

template <int W>
TOILE_LANE_KERNEL void evaluate_springs(const SpringGraph& graph, const double* position, const double* predicted,
                                        double* gradient, SpringValue<W>& value) {
    const int vertices = graph.vertex_count;
    const int* first = graph.first.data();
    const SpringGraph::Spring* spring = graph.spring.data();
    const double* target = graph.target.data();
    const Lane<W> zero = lane_broadcast<W>(0.0);
    Lane<W> energy = zero, size = zero, largest = zero, lost = zero;
    for (int i = 0; i < 3 * vertices; ++i) store_lanes<W>(gradient + i * W, zero);
    for (int a = 0; a < vertices; ++a) {
        const double* at = position + 3 * W * a;
        const LaneVector<W> x = load_vector<W>(at), off = difference<W>(at, predicted + 3 * W * a);
        LaneVector<W> g = load_vector<W>(gradient + 3 * W * a);
        const double z = target[a];
        g = {g.x + z * off.x, g.y + z * off.y, g.z + z * off.z};
        energy += (0.5 * z) * dot<W>(off, off);
        for (int s = first[a]; s < first[a + 1]; ++s) {
            const SpringGraph::Spring one = spring[s];
            const LaneVector<W> end = load_vector<W>(position + 3 * W * one.other);
            const LaneVector<W> d{x.x - end.x, x.y - end.y, x.z - end.z};
            const Lane<W> squared = dot<W>(d, d), length = lane_sqrt(squared), inverse = inverse_length<W>(length);
            const Lane<W> stretch = length - one.rest_length, axial = (0.5 * one.axial) * squared;
            energy += (0.5 * one.stiffness) * stretch * stretch + axial;
            size += lane_abs(axial);
            lost = lane_max(
                lost, lane_select(lane_less(zero, length), zero, lane_broadcast<W>(one.stiffness * one.rest_length)));
            const Lane<W> f = one.stiffness - (one.stiffness * one.rest_length) * inverse + one.axial;
            g = {g.x + f * d.x, g.y + f * d.y, g.z + f * d.z};
            add_to<W>(gradient + 3 * W * one.other, -f, d);
        }
        store_vector<W>(gradient + 3 * W * a, g);
        largest = largest_of<W>(largest, g);
    }
    store_lanes<W>(value.energy, energy);
    store_lanes<W>(value.energy_size, size + lane_abs(energy));
    store_lanes<W>(value.largest, largest);
    store_lanes<W>(value.lost, lost);
}

namespace {

/// A spring's Hessian is (across + axial) I + m mᵀ; of a spring without length, nothing is known but its stiffness.
template <int W>
struct LinearSpring {
    LaneVector<W> m;
    Lane<W> across;
};
template <int W>
[[gnu::always_inline]] inline LinearSpring<W> linearize(const SpringGraph::Spring& spring, const LaneVector<W>& d) {
    const Lane<W> inverse = inverse_length<W>(lane_sqrt(dot<W>(d, d)));
    const Lane<W> force = (spring.stiffness * spring.rest_length) * inverse;
    const Lane<W> scale = lane_sqrt(force) * inverse;
    return {{scale * d.x, scale * d.y, scale * d.z}, spring.stiffness - force};
}

template <int W>
[[gnu::always_inline]] inline void store_form(double* p, const LinearSpring<W>& one) {
    store_vector<W>(p, one.m);
    store_lanes<W>(p + 3 * W, one.across);
}
template <int W>
[[gnu::always_inline]] inline void store_form(SingleLanes<W>* p, const LinearSpring<W>& one) {
    store_floats<W>(p, narrow<W>(one.m.x));
    store_floats<W>(p + 1, narrow<W>(one.m.y));
    store_floats<W>(p + 2, narrow<W>(one.m.z));
    store_floats<W>(p + 3, narrow<W>(one.across));
}
constexpr int entry_size(const double*, int width) {
    return 4 * width;
}
template <int W>
constexpr int entry_size(const SingleLanes<W>*, int) {
    return 4;
}

}  // namespace

template <int W, class Number>
TOILE_LANE_KERNEL void linearize_springs(const SpringGraph& graph, const double* position, const double* exact,
                                         const double* exact_diagonal, Number* form, double* diagonal) {
    const SpringGraph::Spring* spring = graph.spring.data();
    const Lane<W> zero = lane_broadcast<W>(0.0);
    const LaneMask<W> keep = lane_less(zero, load_lanes<W>(exact));
    const LaneMask<W> keep_diagonal = lane_less(zero, load_lanes<W>(exact_diagonal));
    for (int i = 0; i < 6 * graph.vertex_count; ++i) store_lanes<W>(diagonal + W * i, zero);
    for (int a = 0; a < graph.vertex_count; ++a) {
        const LaneVector<W> x = load_vector<W>(position + 3 * W * a);
        double* own = diagonal + 6 * W * a;
        Lane<W> sum[6];
        for (int k = 0; k < 6; ++k) sum[k] = load_lanes<W>(own + W * k);
        for (int k : {0, 2, 5}) sum[k] = sum[k] + graph.target[a];
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) {
            const LaneVector<W> end = load_vector<W>(position + 3 * W * spring[s].other);
            LinearSpring<W> one = linearize<W>(spring[s], {x.x - end.x, x.y - end.y, x.z - end.z});
            const Lane<W> pushed = lane_max(one.across, zero), axial = lane_broadcast<W>(spring[s].axial);
            const Lane<W> t = lane_select(keep_diagonal, one.across, pushed) + axial;
            one.across = lane_select(keep, one.across, pushed) + axial;
            store_form<W>(form + entry_size(form, W) * s, one);
            const LaneVector<W>& m = one.m;
            const Lane<W> block[6] = {t + m.x * m.x, m.y * m.x, t + m.y * m.y, m.z * m.x, m.z * m.y, t + m.z * m.z};
            double* other = diagonal + 6 * W * spring[s].other;
            for (int k = 0; k < 6; ++k) {
                sum[k] = sum[k] + block[k];
                store_lanes<W>(other + k * W, load_lanes<W>(other + k * W) + block[k]);
            }
        }
        for (int k = 0; k < 6; ++k) store_lanes<W>(own + W * k, sum[k]);
    }
}

template <int W>
TOILE_LANE_KERNEL void multiply_hessian(const SpringGraph& graph, const double* position, const double* exact,
                                        const double* x, double* product) {
    const SpringGraph::Spring* spring = graph.spring.data();
    const Lane<W> zero = lane_broadcast<W>(0.0);
    const LaneMask<W> keep = lane_less(zero, load_lanes<W>(exact));
    for (int i = 0; i < 3 * graph.vertex_count; ++i)
        store_lanes<W>(product + W * i, graph.target[i / 3] * load_lanes<W>(x + W * i));
    for (int a = 0; a < graph.vertex_count; ++a) {
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) {
            const int b = spring[s].other;
            const LinearSpring<W> one =
                linearize<W>(spring[s], difference<W>(position + 3 * W * a, position + 3 * W * b));
            const LaneVector<W> d = difference<W>(x + 3 * W * a, x + 3 * W * b), m = one.m;
            const Lane<W> t = lane_select(keep, one.across, lane_max(one.across, zero)) + spring[s].axial;
            const Lane<W> along = dot<W>(m, d);
            add_opposite<W>(product + 3 * W * a, product + 3 * W * b, lane_broadcast<W>(1.0),
                            {t * d.x + along * m.x, t * d.y + along * m.y, t * d.z + along * m.z});
        }
    }
}

template <int W>
TOILE_LANE_KERNEL void multiply_springs(const SpringGraph& graph, const double* form, const double* x, double* product,
                                        double* x_dot_product, double* x_squared) {
    const int vertices = graph.vertex_count;
    const int* first = graph.first.data();
    const SpringGraph::Spring* spring = graph.spring.data();
    const Lane<W> zero = lane_broadcast<W>(0.0);
    Lane<W> sum = zero, squared = zero;
    for (int i = 0; i < 3 * vertices; ++i) store_lanes<W>(product + i * W, zero);
    for (int a = 0; a < vertices; ++a) {
        const LaneVector<W> v = load_vector<W>(x + 3 * W * a);
        LaneVector<W> y = load_vector<W>(product + 3 * W * a);
        const double z = graph.target[a];
        y = {y.x + z * v.x, y.y + z * v.y, y.z + z * v.z};
        for (int s = first[a]; s < first[a + 1]; ++s) {
            const int b = spring[s].other;
            const LaneVector<W> end = load_vector<W>(x + 3 * W * b), m = load_vector<W>(form + 4 * W * s);
            const LaneVector<W> d{v.x - end.x, v.y - end.y, v.z - end.z};
            const Lane<W> t = load_lanes<W>(form + 4 * W * s + 3 * W), along = dot<W>(m, d);
            const LaneVector<W> f{t * d.x + along * m.x, t * d.y + along * m.y, t * d.z + along * m.z};
            y = {y.x + f.x, y.y + f.y, y.z + f.z};
            add_to<W>(product + 3 * W * b, lane_broadcast<W>(-1.0), f);
        }
        store_vector<W>(product + 3 * W * a, y);
        sum += dot<W>(v, y);
        squared += dot<W>(v, v);
    }
    store_lanes<W>(x_dot_product, sum);
    store_lanes<W>(x_squared, squared);
}

template <int W>
TOILE_LANE_KERNEL void dot_moduli(const SpringGraph& graph, const double* position, const double* x, double* sum) {
    Lane<W> edge = lane_broadcast<W>(0.0), bending = edge, axial = edge;
    for (int a = 0; a < graph.vertex_count; ++a) {
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) {
            const int b = graph.spring[s].other;
            const LaneVector<W> d = difference<W>(position + 3 * W * a, position + 3 * W * b);
            const LaneVector<W> e = difference<W>(x + 3 * W * a, x + 3 * W * b);
            const Lane<W> inverse = inverse_length<W>(lane_sqrt(dot<W>(d, d))), along = dot<W>(d, e);
            const SpringGraph::Share& share = graph.share[s];
            edge += (share.edge - share.edge_force * inverse) * along;
            bending += (share.bending - share.bending_force * inverse) * along;
            axial += graph.spring[s].axial * along;
        }
    }
    store_lanes<W>(sum, edge);
    store_lanes<W>(sum + W, bending);
    store_lanes<W>(sum + 2 * W, axial);
}

template <int W>
TOILE_LANE_KERNEL void add_moduli(const SpringGraph& graph, const double* position, const double* factor, double* x) {
    const LaneVector<W> f = load_vector<W>(factor);
    for (int a = 0; a < graph.vertex_count; ++a) {
        for (int s = graph.first[a]; s < graph.first[a + 1]; ++s) {
            const int b = graph.spring[s].other;
            const LaneVector<W> d = difference<W>(position + 3 * W * a, position + 3 * W * b);
            const Lane<W> inverse = inverse_length<W>(lane_sqrt(dot<W>(d, d)));
            const SpringGraph::Share& share = graph.share[s];
            const Lane<W> t = f.x * (share.edge - share.edge_force * inverse) +
                              f.y * (share.bending - share.bending_force * inverse) + f.z * graph.spring[s].axial;
            add_opposite<W>(x + 3 * W * a, x + 3 * W * b, t, d);
        }
    }
}

#define TOILE_INSTANTIATE(W)                                                                                        \
    template void evaluate_springs<W>(const SpringGraph&, const double*, const double*, double*, SpringValue<W>&);  \
    template void linearize_springs<W>(const SpringGraph&, const double*, const double*, const double*, double*,    \
                                       double*);                                                                    \
    template void linearize_springs<W>(const SpringGraph&, const double*, const double*, const double*,             \
                                       SingleLanes<W>*, double*);                                                   \
    template void multiply_hessian<W>(const SpringGraph&, const double*, const double*, const double*, double*);    \
    template void multiply_springs<W>(const SpringGraph&, const double*, const double*, double*, double*, double*); \
    template void dot_moduli<W>(const SpringGraph&, const double*, const double*, double*);                         \
    template void add_moduli<W>(const SpringGraph&, const double*, const double*, double*);
TOILE_INSTANTIATE(1)
TOILE_INSTANTIATE(8)
#undef TOILE_INSTANTIATE

}  // namespace toile::prior

#include "prior/inextensibility_buffers.h"

#include <cmath>
#include <numeric>
#include <utility>

namespace toile::prior {

InextensibilityShared::InextensibilityShared(const InextensibilityModel& model)
    : vertex_count(model.vertex_count), edge_count(static_cast<int>(model.edge.rows())) {
    std::vector<std::pair<int, int>> pairs;
    pairs.reserve(edge_count);
    for (int e = 0; e < edge_count; ++e) pairs.emplace_back(model.edge(e, 0), model.edge(e, 1));
    symbolic = std::make_shared<const BlockSymbolic>(vertex_count, pairs);
    edge.resize(2 * edge_count);
    slot.resize(edge_count);
    for (int e = 0; e < edge_count; ++e) {
        edge[2 * e] = model.edge(e, 0);
        edge[2 * e + 1] = model.edge(e, 1);
        slot[e] = symbolic->slot(model.edge(e, 0), model.edge(e, 1));
    }
    stiffness_scale = model.target_stiffness.mean();
    stiffness.resize(vertex_count);
    for (int v = 0; v < vertex_count; ++v) stiffness[v] = model.target_stiffness[v] / stiffness_scale;
    scale(model);

    std::vector<double> value(symbolic->slot_count(), 0.0);
    for (int v = 0; v < vertex_count; ++v) value[v] = stiffness[v];
    for (int e = 0; e < edge_count; ++e) {
        value[edge[2 * e]] += penalty;
        value[edge[2 * e + 1]] += penalty;
        value[slot[e]] -= penalty;
    }
    constant = std::make_unique<const ScalarCholesky>(symbolic, value);
}

void InextensibilityShared::scale(const InextensibilityModel& model) {
    length = edge_count > 0 ? model.edge_max_length.mean() : 1.0;
    limit.resize(edge_count);
    for (int e = 0; e < edge_count; ++e) limit[e] = model.edge_max_length[e] / length;
}

template <int W>
InextensibilityBuffers<W>::InextensibilityBuffers(const InextensibilityShared& given) : shared(given), lanes{} {
    const std::size_t v = 3 * static_cast<std::size_t>(shared.vertex_count), e = shared.edge_count;
    lanes.vertex_count = shared.vertex_count;
    lanes.edge_count = shared.edge_count;
    lanes.edge = shared.edge.data();
    lanes.slot = shared.slot.data();
    lanes.limit = shared.limit.data();
    lanes.stiffness = shared.stiffness.data();
    for (double** p : {&lanes.predicted, &lanes.position, &lanes.stationarity, &lanes.step, &lanes.trial}) *p = take(v);
    for (double** p : {&lanes.primal, &lanes.slack, &lanes.multiplier, &lanes.target, &lanes.slack_step,
                       &lanes.multiplier_step, &lanes.slack_trial, &lanes.multiplier_trial})
        *p = take(e);
    for (double** p : {&lanes.direction, &lanes.split, &lanes.dual}) *p = take(3 * e);
}

template <int W>
void InextensibilityBuffers<W>::make_matrix() {
    if (cholesky) return;
    lanes.block = take(9 * static_cast<std::size_t>(shared.symbolic->slot_count()));
    cholesky = std::make_unique<LaneCholesky<W>>(shared.symbolic);
}

template <int W>
void InextensibilityBuffers<W>::take_lane(int lane, const InextensibilityBuffers& from, int from_lane) {
    const auto copy = [&](double* to, const double* source, int count) {
        for (int i = 0; i < count; ++i) to[i * W + lane] = source[i * W + from_lane];
    };
    origin[lane] = from.origin[from_lane];
    copy(lanes.predicted, from.lanes.predicted, 3 * shared.vertex_count);
    copy(lanes.position, from.lanes.position, 3 * shared.vertex_count);
    copy(lanes.slack, from.lanes.slack, shared.edge_count);
    copy(lanes.multiplier, from.lanes.multiplier, shared.edge_count);
}

template <int W>
double* InextensibilityBuffers<W>::take(std::size_t doubles) {
    storage_.emplace_back(doubles * W);
    return storage_.back().data();
}

template <int W>
bool InextensibilityBuffers<W>::load_predicted(int lane, const double* position) {
    const int count = shared.vertex_count;
    std::array<double, 3> mean{};
    bool finite = true;
    for (int i = 0; i < 3 * count; ++i) {
        finite = finite && std::isfinite(position[i]);
        mean[i % 3] += position[i] / count;
    }
    origin[lane] = finite ? mean : std::array<double, 3>{};
    const double inverse = 1.0 / shared.length;
    for (int i = 0; i < 3 * count; ++i)
        lanes.predicted[i * W + lane] = finite ? (position[i] - mean[i % 3]) * inverse : 0.0;
    return finite;
}

template <int W>
void InextensibilityBuffers<W>::load_position(int lane, const double* position) {
    const double inverse = 1.0 / shared.length;
    for (int i = 0; i < 3 * shared.vertex_count; ++i)
        lanes.position[i * W + lane] = (position[i] - origin[lane][i % 3]) * inverse;
}

template <int W>
void InextensibilityBuffers<W>::load_multiplier(int lane, const double* multiplier) {
    const double inverse = 1.0 / (shared.length * shared.stiffness_scale);
    for (int e = 0; e < shared.edge_count; ++e) lanes.multiplier[e * W + lane] = multiplier[e] * inverse;
}

template <int W>
void InextensibilityBuffers<W>::store_position(int lane, double* position) const {
    for (int i = 0; i < 3 * shared.vertex_count; ++i)
        position[i] = origin[lane][i % 3] + shared.length * lanes.position[i * W + lane];
}

template <int W>
void InextensibilityBuffers<W>::store_multiplier(int lane, double* multiplier) const {
    const double scale = shared.length * shared.stiffness_scale;
    for (int e = 0; e < shared.edge_count; ++e) multiplier[e] = scale * lanes.multiplier[e * W + lane];
}

template class InextensibilityBuffers<1>;
template class InextensibilityBuffers<8>;

}  // namespace toile::prior

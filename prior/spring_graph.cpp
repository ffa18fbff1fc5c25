#include "prior/spring_graph.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace toile::prior {

struct SpringGraph::Pair {
    int a, b;  // a < b
    Share share;
    double axial;
};

namespace {

double power_of_two_near(double x) {
    return std::isfinite(x) && x > 0.0 ? std::exp2(std::round(std::log2(x))) : 1.0;
}

std::vector<std::vector<int>> neighbours(int vertex_count, const std::vector<std::pair<int, int>>& pairs) {
    std::vector<std::vector<int>> next(static_cast<size_t>(vertex_count));
    for (const auto& [a, b] : pairs) {
        next[a].push_back(b);
        next[b].push_back(a);
    }
    for (std::vector<int>& list : next) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return next;
}

/// Vertices of the component of `root` in breadth-first order, those of few neighbours first; marks them.
std::vector<int> breadth_first(const std::vector<std::vector<int>>& next, int root, std::vector<bool>& seen) {
    std::vector<int> order{root};
    seen[root] = true;
    for (size_t i = 0; i < order.size(); ++i) {
        const size_t begin = order.size();
        for (int w : next[order[i]]) {
            if (seen[w]) continue;
            seen[w] = true;
            order.push_back(w);
        }
        std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end(),
                         [&](int v, int w) { return next[v].size() < next[w].size(); });
    }
    return order;
}

/// Reverse Cuthill-McKee: neighbours close together, for the caches and for the incomplete factor.
std::vector<int> banded_order(const std::vector<std::vector<int>>& next) {
    std::vector<int> order;
    std::vector<bool> seen(next.size(), false);
    for (int v = 0; v < static_cast<int>(next.size()); ++v) {
        if (seen[v]) continue;
        std::vector<bool> trial = seen;
        const int far_end = breadth_first(next, v, trial).back();
        const std::vector<int> component = breadth_first(next, far_end, seen);
        order.insert(order.end(), component.begin(), component.end());
    }
    std::reverse(order.begin(), order.end());
    return order;
}

std::vector<std::pair<int, int>> stencil_pairs(const QuasistaticModel& model) {
    std::vector<std::pair<int, int>> pairs;
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); ++e)
        pairs.emplace_back(model.edge_spring(e, 0), model.edge_spring(e, 1));
    for (Eigen::Index e = 0; e < model.bending_spring.rows(); ++e)
        pairs.emplace_back(model.bending_spring(e, 0), model.bending_spring(e, 1));
    for (Eigen::Index e = 0; e < model.axial_spring.rows(); ++e)
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j) pairs.emplace_back(model.axial_spring(e, i), model.axial_spring(e, j));
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    return pairs;
}

}  // namespace

SpringGraph::SpringGraph(const QuasistaticModel& model) : vertex_count(model.vertex_count) {
    vertex = banded_order(neighbours(vertex_count, stencil_pairs(model)));
    std::vector<int> place(static_cast<size_t>(vertex_count));
    for (int i = 0; i < vertex_count; ++i) place[vertex[i]] = i;

    if (model.edge_spring.rows() > 0) {
        length_unit = power_of_two_near(model.edge_rest_length.mean());
        stiffness_unit = power_of_two_near(model.edge_stiffness.mean());
        reference_force = model.edge_stiffness.dot(model.edge_rest_length) /
                          static_cast<double>(model.edge_spring.rows()) / (stiffness_unit * length_unit);
    } else {
        stiffness_unit = power_of_two_near(model.target_stiffness.mean());
    }

    std::vector<Pair> pairs;
    const auto add = [&](int a, int b, const Share& share, double axial) {
        if (a == b) return;
        const auto [low, high] = std::minmax(place[a], place[b]);
        pairs.push_back({low, high, share, axial});
    };
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); ++e) {
        const double k = model.edge_stiffness[e] / stiffness_unit;
        add(model.edge_spring(e, 0), model.edge_spring(e, 1),
            {k, k * (model.edge_rest_length[e] / length_unit), 0.0, 0.0}, 0.0);
    }
    for (Eigen::Index e = 0; e < model.bending_spring.rows(); ++e) {
        const double k = model.bending_stiffness[e] / stiffness_unit;
        add(model.bending_spring(e, 0), model.bending_spring(e, 1),
            {0.0, 0.0, k, k * (model.bending_rest_length[e] / length_unit)}, 0.0);
    }
    for (Eigen::Index e = 0; e < model.axial_spring.rows(); ++e) {
        const double u = model.axial_weight(e, 0), v = model.axial_weight(e, 1);
        const double k = model.axial_stiffness[e] / stiffness_unit, weight[4] = {1.0 - u, u, v - 1.0, -v};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                add(model.axial_spring(e, i), model.axial_spring(e, j), {}, -k * weight[i] * weight[j]);
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& p, const Pair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); });
    add_springs(pairs);
    list_rows();
    list_updates();
    set_target(model);
}

void SpringGraph::set_target(const QuasistaticModel& model) {
    target.resize(static_cast<size_t>(vertex_count));
    for (int i = 0; i < vertex_count; ++i) target[i] = model.target_stiffness[vertex[i]] / stiffness_unit;
}

void SpringGraph::add_springs(const std::vector<Pair>& pairs) {
    first.assign(static_cast<size_t>(vertex_count) + 1, 0);
    for (size_t i = 0; i < pairs.size();) {
        Share sum{};
        double axial = 0.0;
        const Pair& pair = pairs[i];
        for (; i < pairs.size() && pairs[i].a == pair.a && pairs[i].b == pair.b; ++i) {
            sum.edge += pairs[i].share.edge;
            sum.edge_force += pairs[i].share.edge_force;
            sum.bending += pairs[i].share.bending;
            sum.bending_force += pairs[i].share.bending_force;
            axial += pairs[i].axial;
        }
        const double stiffness = sum.edge + sum.bending, force = sum.edge_force + sum.bending_force;
        spring.push_back({pair.b, stiffness, stiffness > 0.0 ? force / stiffness : 0.0, axial});
        share.push_back(sum);
        ++first[pair.a + 1];
    }
    for (int v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
}

void SpringGraph::list_rows() {
    row_first.assign(static_cast<size_t>(vertex_count) + 1, 0);
    for (const Spring& one : spring) ++row_first[one.other + 1];
    for (int v = 0; v < vertex_count; ++v) {
        widest_row = std::max(widest_row, row_first[v + 1]);
        row_first[v + 1] += row_first[v];
    }
    entry.resize(spring.size());
    std::vector<int> at(row_first.begin(), row_first.end() - 1);
    for (int a = 0; a < vertex_count; ++a)
        for (int s = first[a]; s < first[a + 1]; ++s) entry[at[spring[s].other]++] = {a, s, 0};
}

void SpringGraph::list_updates() {
    for (int i = 0; i < vertex_count; ++i) {
        for (int e = row_first[i]; e < row_first[i + 1]; ++e) {
            const int j = entry[e].column;
            for (int left = row_first[i], right = row_first[j]; left < e && right < row_first[j + 1];) {
                if (entry[left].column == entry[right].column) update.push_back({left - row_first[i], right});
                const bool advance_left = entry[left].column <= entry[right].column;
                const bool advance_right = entry[right].column <= entry[left].column;
                left += advance_left;
                right += advance_right;
            }
            entry[e].update_end = static_cast<int>(update.size());
        }
    }
}

}  // namespace toile::prior

#include "generate/stored_body.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace toile::generate {
namespace {

Positions carried(const files::DatasetEmbedding& embedding, const Triangles& triangle, const Positions& posed) {
    Positions position = Positions::Zero(embedding.barycentric.rows(), 3);
    for (Eigen::Index v = 0; v < position.rows(); ++v)
        for (int k = 0; k < 3; ++k)
            position.row(v) += embedding.barycentric(v, k) * posed.row(triangle(embedding.triangle[v], k));
    return position;
}

}  // namespace

skin::Body skinned_body(const files::DatasetBody& stored) {
    skin::Body body;
    body.rest_position = stored.rest_position;
    body.triangle = stored.triangle;
    for (size_t j = 0; j < stored.joint_name.size(); ++j)
        body.joint.push_back({stored.joint_name[j], stored.joint_parent[j], stored.joint_bind[j]});
    std::vector<size_t> order(stored.weight_vertex.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return stored.weight_vertex[a] < stored.weight_vertex[b]; });
    body.weight.offset.assign(static_cast<size_t>(body.vertex_count()) + 1, 0);
    for (const size_t i : order) {
        ++body.weight.offset[stored.weight_vertex[i] + 1];
        body.weight.joint.push_back(stored.weight_joint[i]);
        body.weight.value.push_back(stored.weight_value[i]);
    }
    std::partial_sum(body.weight.offset.begin(), body.weight.offset.end(), body.weight.offset.begin());
    return body;
}

CarriedBody posed_as_stored(const files::DatasetHeader& header, const skin::Body& body,
                            const files::SampleRecord& sample) {
    CarriedBody best;
    best.distance = std::numeric_limits<double>::infinity();
    for (const auto method : {skin::SkinningMethod::linear, skin::SkinningMethod::dual_quaternion}) {
        Positions posed = skin::skin_positions(body, sample.pose, method);
        const Positions cloth = carried(*header.embedding, body.triangle, posed);
        const double distance = (cloth - sample.embedded).rowwise().norm().maxCoeff();
        if (distance < best.distance || best.position.rows() == 0) best = {std::move(posed), method, distance};
        if (best.distance < 1e-5) break;
    }
    return best;
}

}  // namespace toile::generate

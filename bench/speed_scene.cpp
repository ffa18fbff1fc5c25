#include "bench/speed_scene.h"

#include <cmath>

#include "evaluate/problem_meshes.h"
#include "evaluate/stress_predictions.h"

namespace toile::bench {
namespace {

constexpr double edge_length = 0.015, shake = 0.15;
constexpr double least_error = 0.001, largest_error = 0.03, white_share = 0.05;

}  // namespace

SpeedScene speed_scene(int around, int along, int samples) {
    evaluate::Random random(2020);
    SpeedScene scene;
    scene.mesh = evaluate::open_tube(around, along, edge_length, shake, random);
    scene.rest = prior::rest_state(scene.mesh);
    scene.samples = samples;
    const auto append = [](std::vector<double>& all, const Positions& position) {
        all.insert(all.end(), position.data(), position.data() + position.size());
    };
    for (int s = 0; s < samples; ++s) {
        // Sizes of error in no order: neighbours in a batch are as unlike as they come in training.
        const double place = samples > 1 ? (s * 29 % samples) / (samples - 1.0) : 0.5;
        const double error = least_error * std::pow(largest_error / least_error, place);
        const Positions& rest = scene.mesh.rest_position;
        const Positions predicted = evaluate::predicted_positions(rest, error, white_share, random);
        append(scene.predicted, predicted);
        append(scene.moved, predicted + 0.01 * error * evaluate::smooth_field(rest, random));
        append(scene.loss_gradient, white_field(scene.mesh.vertex_count(), random));
    }
    return scene;
}

double SpeedScene::overstretched_share() const {
    Eigen::Index longer = 0;
    for (int s = 0; s < samples; ++s) {
        const Eigen::Map<const Positions> r(predicted.data() + s * 3 * rest.vertex_count, rest.vertex_count, 3);
        for (Eigen::Index e = 0; e < rest.edge.rows(); ++e)
            longer += (r.row(rest.edge(e, 0)) - r.row(rest.edge(e, 1))).norm() > rest.edge_rest_length[e];
    }
    return static_cast<double>(longer) / static_cast<double>(samples * rest.edge.rows());
}

}  // namespace toile::bench

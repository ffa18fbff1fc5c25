#include "evaluate/stress_predictions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile::evaluate {
namespace {

using Eigen::RowVector3d;

RowVector3d random_vector(Random& random) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return {x, y, z};
}

double extent(const Positions& position) {
    return (position.colwise().maxCoeff() - position.colwise().minCoeff()).norm();
}

void make_unit(Positions& field) {
    const double rms = std::sqrt(field.squaredNorm() / static_cast<double>(field.rows()));
    if (rms > 0) field /= rms;
}

Positions shuffled_rows(Positions position, Random& random) {
    for (int v = static_cast<int>(position.rows()) - 1; v > 0; --v)
        position.row(v).swap(position.row(random.integer(0, v)));
    return position;
}

}  // namespace

std::string_view name(PredictionKind kind) {
    constexpr std::array<std::string_view, prediction_kind_count> names{
        "noise", "low_frequency", "mixed",    "feasible", "rest",       "stretched", "point", "line",
        "plane", "mirrored",      "shuffled", "shrunk",   "far_vertex", "far_away",  "torn"};
    return names[static_cast<std::size_t>(kind)];
}

Positions smooth_field(const Positions& rest, Random& random) {
    constexpr int waves = 6;
    const double size = std::max(extent(rest), 1e-300);
    Positions field = Positions::Zero(rest.rows(), 3);
    for (int w = 0; w < waves; ++w) {
        const RowVector3d amplitude = random_vector(random);
        const RowVector3d direction = random_vector(random).normalized();
        const double wave_number = 2 * std::numbers::pi / (size * random.log_uniform(0.25, 2.0));
        const double phase = random.uniform(0, 2 * std::numbers::pi);
        for (Eigen::Index v = 0; v < rest.rows(); ++v)
            field.row(v) += std::sin(wave_number * rest.row(v).dot(direction) + phase) * amplitude;
    }
    make_unit(field);
    return field;
}

Positions white_field(int vertices, Random& random) {
    Positions field(vertices, 3);
    for (double& x : field.reshaped<Eigen::RowMajor>()) x = random.normal();
    make_unit(field);
    return field;
}

Positions bent(const Positions& rest, Random& random) {
    const RowVector3d lower = rest.colwise().minCoeff(), upper = rest.colwise().maxCoeff();
    const double turn = random.uniform(0.1, 1.0) * std::numbers::pi;
    const double radius = std::max((upper - lower).norm(), 1e-300) / turn;
    Positions result(rest.rows(), 3);
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        const RowVector3d p = rest.row(v) - 0.5 * (lower + upper);
        const double angle = p[1] / radius;
        result.row(v) << p[0], (radius - p[2]) * std::sin(angle), radius - (radius - p[2]) * std::cos(angle);
    }
    return result;
}

Positions predicted_positions(const Positions& rest, double rms, double white_share, Random& random) {
    Positions error = std::sqrt(white_share) * white_field(static_cast<int>(rest.rows()), random);
    error += std::sqrt(1 - white_share) * smooth_field(rest, random);
    make_unit(error);
    return bent(rest, random) + rms * error;
}

namespace {

/// The part of a prediction that is its kind's own, before noise.
Positions shape(const Positions& rest, PredictionKind kind, double stretch_limit, Random& random) {
    const double size = extent(rest);
    Positions result = rest;
    switch (kind) {
        case PredictionKind::noise:
            return bent(rest, random);
        case PredictionKind::low_frequency:
        case PredictionKind::mixed:
            return bent(rest, random) + random.log_uniform(1e-3, 1.0) * size * smooth_field(rest, random);
        case PredictionKind::feasible:
            return random.uniform(0.5, 0.95) * (1 + std::min(stretch_limit, 0.0)) * rest;
        case PredictionKind::rest:
        case PredictionKind::far_away:
            break;
        case PredictionKind::stretched:
            return (1 + random.log_uniform(1e-6, 1e2)) * rest;
        case PredictionKind::point:
            result.rowwise() = random_vector(random) * size;
            break;
        case PredictionKind::line: {
            const RowVector3d direction = random_vector(random).normalized();
            for (Eigen::Index v = 0; v < rest.rows(); ++v) result.row(v) = rest.row(v).dot(direction) * direction;
            break;
        }
        case PredictionKind::plane: {
            const RowVector3d normal = random_vector(random).normalized();
            for (Eigen::Index v = 0; v < rest.rows(); ++v) result.row(v) -= rest.row(v).dot(normal) * normal;
            break;
        }
        case PredictionKind::mirrored:
            result.col(random.integer(0, 2)) *= -1;
            break;
        case PredictionKind::shuffled:
            return shuffled_rows(rest, random);
        case PredictionKind::shrunk:
            return (1e-3 / size) * rest;
        case PredictionKind::far_vertex:
            result.row(random.integer(0, static_cast<int>(rest.rows()) - 1)) +=
                100.0 * random_vector(random).normalized();
            break;
        case PredictionKind::torn: {
            const RowVector3d away = 10 * size * random_vector(random).normalized();
            for (Eigen::Index v = 0; v < rest.rows() / 2; ++v) result.row(v) += away;
            break;
        }
    }
    return result;
}

/// How often a kind comes with white noise on top: exact degeneracy is hard for one solver, near degeneracy for
/// another.
double noise_probability(PredictionKind kind) {
    switch (kind) {
        case PredictionKind::low_frequency:
        case PredictionKind::feasible:
        case PredictionKind::rest:
        case PredictionKind::shrunk:
            return 0.0;
        case PredictionKind::stretched:
        case PredictionKind::point:
        case PredictionKind::line:
        case PredictionKind::plane:
        case PredictionKind::mirrored:
        case PredictionKind::shuffled:
        case PredictionKind::torn:
            return 0.5;
        default:
            return 1.0;
    }
}

}  // namespace

Positions extreme_positions(const Positions& rest, PredictionKind kind, double edge_length, double noise,
                            double stretch_limit, Random& random) {
    Positions result = shape(rest, kind, stretch_limit, random);
    if (random.chance(noise_probability(kind)))
        result += noise * edge_length * white_field(static_cast<int>(rest.rows()), random);
    if (kind == PredictionKind::far_away) result.rowwise() += 1000.0 * random_vector(random).normalized();
    return result;
}

}  // namespace toile::evaluate

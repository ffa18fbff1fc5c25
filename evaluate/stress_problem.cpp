#include "evaluate/stress_problem.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "evaluate/problem_meshes.h"

namespace toile::evaluate {
namespace {

/// A mesh of about `vertices` vertices, in metres.
ClothMesh draw_mesh(MeshKind kind, int vertices, double edge_length, Random& random) {
    const double shake = random.uniform(0.0, 0.3);
    const int narrow = std::max(2, static_cast<int>(std::sqrt(vertices) * random.log_uniform(0.4, 1.0)));
    const int wide = std::max(2, vertices / narrow);
    switch (kind) {
        case MeshKind::tube: {
            const int around = std::max(3, random.chance(0.5) ? narrow : wide);
            return open_tube(around, std::max(2, vertices / around), edge_length, shake, random);
        }
        case MeshKind::patch:
            return flat_patch(narrow, wide, edge_length, shake, random);
        case MeshKind::irregular:
            return irregular_patch(narrow, wide, edge_length, random);
        case MeshKind::pieces:
            return several_pieces(vertices, edge_length, random);
        case MeshKind::fin:
            break;
    }
    return patch_with_fin(std::max(2, 2 * narrow / 3), wide, edge_length, random);
}

/// Uniform density (no masses), another total weight, or a mass of its own for each vertex.
void draw_mass(ClothMesh& mesh, Random& random) {
    const int way = random.integer(0, 2);
    if (way == 0) return;
    const double level = random.log_uniform(1e-6, 1e3);
    mesh.mass.resize(mesh.vertex_count());
    for (double& mass : mesh.mass) mass = level * (way == 1 ? 1.0 : random.log_uniform(0.1, 10.0));
}

void draw_model(StressProblem& problem, Random& random) {
    problem.tolerance = random.chance(0.2) ? 1e-4 : 1e-6;
    problem.stretch_limit = random.chance(0.4) ? 0.0 : random.uniform(-0.1, 0.5);
    problem.mu = random.log_uniform(1e-4, 1e4);
    problem.mu_varies = random.chance(0.3);
    problem.stretch = random.log_uniform(1e-3, 1e3);
    problem.bending = random.log_uniform(1e-3, 1e3);
    problem.axial = random.log_uniform(1e-3, 1e3);
}

/// A kilometre off, double precision leaves 1e-13 m: less noise than this would be lost in rounding, whoever solves it.
double least_noise(PredictionKind kind) {
    return kind == PredictionKind::far_away || kind == PredictionKind::far_vertex ? 1e-2 : 1e-5;
}

void draw_samples(StressProblem& problem, const Positions& rest, Random& random) {
    const int samples = rest.rows() > 5000 || random.chance(0.6) ? 1 : random.integer(2, 9);
    for (int s = 0; s < samples; ++s) {
        const auto kind = static_cast<PredictionKind>(random.integer(0, prediction_kind_count - 1));
        const double noise = random.log_uniform(least_noise(kind), 1e2);
        const Positions position = problem.length_unit * extreme_positions(rest, kind, problem.edge_length, noise,
                                                                           problem.stretch_limit, random);
        problem.kind.push_back(kind);
        problem.noise.push_back(noise);
        problem.predicted.insert(problem.predicted.end(), position.data(), position.data() + position.size());
    }
}

}  // namespace

std::string_view name(PriorKind kind) {
    return kind == PriorKind::inextensibility ? "inextensibility" : "quasistatic";
}

std::string_view name(MeshKind kind) {
    constexpr std::array<std::string_view, 5> names{"tube", "patch", "irregular", "pieces", "fin"};
    return names[static_cast<std::size_t>(kind)];
}

StressProblem draw_problem(const StressDraw& draw, int number) {
    Random random(draw.seed, static_cast<std::uint64_t>(number));
    StressProblem problem;
    problem.number = number;
    problem.prior = draw.quasistatic && number % 2 == 1 ? PriorKind::quasistatic : PriorKind::inextensibility;
    problem.mesh_kind = static_cast<MeshKind>(random.integer(0, 4));
    problem.edge_length = random.log_uniform(0.002, 0.1);
    constexpr std::array<double, 3> units{1.0, 1000.0, 1e-3};
    problem.length_unit = units[random.integer(0, 2)];
    // Pairs of problems, so that both priors get their share of the huge ones.
    const bool huge = draw.huge_every > 0 && (number / 2) % draw.huge_every == draw.huge_every / 2;
    const double vertices = huge ? random.uniform(10'000, 20'000) : random.log_uniform(draw.smallest, draw.largest);
    problem.mesh = draw_mesh(problem.mesh_kind, static_cast<int>(vertices), problem.edge_length, random);
    if (random.chance(0.5)) renumber_vertices(problem.mesh, random);
    draw_mass(problem.mesh, random);
    draw_model(problem, random);
    draw_samples(problem, problem.mesh.rest_position, random);
    problem.mesh.rest_position *= problem.length_unit;
    problem.check_derivative = random.chance(0.2);
    problem.derivative_seed = static_cast<std::uint64_t>(random.integer(0, 1 << 30));
    return problem;
}

Eigen::VectorXd StressProblem::mu_of_vertices() const {
    Eigen::VectorXd all = Eigen::VectorXd::Constant(mesh.vertex_count(), mu);
    if (!mu_varies) return all;
    Random random(derivative_seed + 1);
    for (double& value : all) value = mu * random.log_uniform(0.1, 10.0);
    return all;
}

std::string StressProblem::description(int sample) const {
    std::ostringstream line;
    line.precision(4);
    line << name(prior) << ' ' << name(mesh_kind) << " of " << mesh.vertex_count() << " vertices, sample " << sample
         << " of " << sample_count() << ": " << name(kind[sample]) << ", noise " << noise[sample]
         << " edge lengths, edge length " << edge_length << " m, " << length_unit << " units to a metre, "
         << (mesh.mass.size() == 0 ? "no masses" : "masses around ");
    if (mesh.mass.size() > 0) line << mesh.mass.mean();
    line << ", tolerance " << tolerance;
    if (prior == PriorKind::inextensibility)
        line << ", stretch limit " << stretch_limit;
    else
        line << ", mu " << mu << (mu_varies ? " (varies)" : "") << ", stiffness times " << stretch << ' ' << bending
             << ' ' << axial;
    return line.str();
}

}  // namespace toile::evaluate

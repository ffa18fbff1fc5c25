#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "evaluate/stress_predictions.h"

namespace toile::evaluate {

enum class PriorKind { inextensibility, quasistatic };
enum class MeshKind { tube, patch, irregular, pieces, fin };

std::string_view name(PriorKind kind);
std::string_view name(MeshKind kind);

/// What a stress run draws its problems from. A problem depends on these and on its own number alone.
struct StressDraw {
    std::uint64_t seed = 1;
    int smallest = 10;        ///< vertices, drawn evenly in the logarithm
    int largest = 1500;       ///< vertices
    int huge_every = 500;     ///< each so-manieth problem has 10,000 to 20,000 vertices; 0: none
    bool quasistatic = true;  ///< every other problem is one of the quasistatic prior
};

/// One random problem: a mesh, one model, and one to nine samples that are projected together.
struct StressProblem {
    int number = 0;
    PriorKind prior = PriorKind::inextensibility;
    MeshKind mesh_kind = MeshKind::patch;
    ClothMesh mesh;                    ///< in `length_unit`
    double length_unit = 1;            ///< numbers to a metre: 1, 1000 (millimetres) or 1e-3 (kilometres)
    double edge_length = 0;            ///< typical [m]
    std::vector<PredictionKind> kind;  ///< `[N]`
    std::vector<double> noise;         ///< `[N]` in edge lengths
    std::vector<double> predicted;     ///< `[N x V x 3]` in `length_unit`
    double tolerance = 1e-6;
    double stretch_limit = 0;                    ///< inextensibility
    double mu = 0.1;                             ///< quasistatic
    bool mu_varies = false;                      ///< quasistatic: by vertex, up to a factor of ten either way
    double stretch = 1, bending = 1, axial = 1;  ///< quasistatic: factors on the default stiffnesses
    bool check_derivative = false;
    std::uint64_t derivative_seed = 0;

    int sample_count() const { return static_cast<int>(kind.size()); }
    /// μ_i `[V]` of the quasistatic prior.
    Eigen::VectorXd mu_of_vertices() const;
    /// One line with all that was drawn for a sample.
    std::string description(int sample) const;
};

StressProblem draw_problem(const StressDraw& draw, int number);

}  // namespace toile::evaluate

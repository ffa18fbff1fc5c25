#include <algorithm>
#include <cmath>

#include "cloth/error.h"
#include "prior/quasistatic.h"

namespace toile::prior {
namespace {

/// Target stiffness of a vertex of mean mass at μ = 1 [N/m].
constexpr double target_modulus = 200.0;

void require(bool holds, const char* what, double value, const char* bound) {
    if (!holds) throw Error(std::string(what) + " is " + std::to_string(value) + "; it must be " + bound);
}

bool not_negative(double x) {
    return std::isfinite(x) && x >= 0.0;
}
bool positive(double x) {
    return std::isfinite(x) && x > 0.0;
}

/// Which edges belong to a pair of triangles: the others bound the cloth and carry half.
std::vector<bool> inner_edges(const RestState& rest) {
    std::vector<std::pair<int, int>> shared;
    for (Eigen::Index h = 0; h < rest.hinge.rows(); ++h)
        shared.push_back(std::minmax<int>(rest.hinge(h, 0), rest.hinge(h, 1)));
    std::sort(shared.begin(), shared.end());
    std::vector<bool> inner;
    for (Eigen::Index e = 0; e < rest.edge.rows(); ++e) {
        const std::pair<int, int> edge = std::minmax<int>(rest.edge(e, 0), rest.edge(e, 1));
        inner.push_back(std::binary_search(shared.begin(), shared.end(), edge));
    }
    return inner;
}

/// 1 / |w|² of each axial spring's weights (1-u, u, v-1, -v).
Eigen::VectorXd axial_share(const Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>& weight) {
    const auto square = [](const auto& x) { return (1.0 - x).square() + x.square(); };
    return (square(weight.col(0).array()) + square(weight.col(1).array())).inverse().matrix();
}

}  // namespace

QuasistaticModel QuasistaticModel::from(const RestState& rest, const QuasistaticStiffness& stiffness, double mu) {
    require(positive(stiffness.stretch), "the stretch stiffness", stiffness.stretch, "above 0 N/m");
    require(not_negative(stiffness.bending), "the bending stiffness", stiffness.bending, "0 N/m or more");
    require(not_negative(stiffness.axial), "the axial stiffness", stiffness.axial, "0 N/m or more");
    require(positive(mu), "mu", mu, "above 0");
    QuasistaticModel model;
    model.vertex_count = rest.vertex_count;
    model.edge_spring = rest.edge;
    model.edge_rest_length = rest.edge_rest_length;
    model.edge_stiffness.setConstant(rest.edge.rows(), std::sqrt(0.75) * stiffness.stretch);
    const std::vector<bool> inner = inner_edges(rest);
    for (Eigen::Index e = 0; e < rest.edge.rows(); ++e)
        if (!inner[static_cast<size_t>(e)]) model.edge_stiffness[e] *= 0.5;
    model.bending_spring = rest.hinge.rightCols(2);
    model.bending_rest_length = rest.hinge_rest_length;
    model.bending_stiffness.setConstant(rest.hinge.rows(), stiffness.bending);
    model.axial_spring = rest.hinge;
    model.axial_weight = rest.hinge_crossing;
    model.axial_stiffness = stiffness.axial * axial_share(rest.hinge_crossing);
    model.target_unit = target_modulus / rest.mass.mean() * rest.mass;
    model.target_stiffness = mu * model.target_unit;
    return model;
}

void QuasistaticOptions::validate() const {
    require(tolerance >= 1e-12 && tolerance <= 0.1, "the tolerance of the quasistatic prior", tolerance,
            "from 1e-12 to 0.1");
    require(max_iterations >= 1, "max_iterations of the quasistatic prior", max_iterations, "at least 1");
}

}  // namespace toile::prior

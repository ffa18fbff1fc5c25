#include "prior/cone_program.h"

namespace toile::prior {

ConeProgram::ConeProgram(const InextensibilityModel& model)
    : edge(model.edge),
      length_unit(model.edge.rows() > 0 ? model.edge_max_length.mean() : 1.0),
      stiffness_unit(model.target_stiffness.mean()) {
    limit = model.edge_max_length / length_unit;
    stiffness = model.target_stiffness / stiffness_unit;
    edge_vector.setZero(3, edge.rows());
}

void ConeProgram::set_predicted(std::span<const double> predicted) {
    const Eigen::Map<const Positions> point(predicted.data(), stiffness.size(), 3);
    for (Eigen::Index e = 0; e < edge.rows(); ++e)
        edge_vector.col(e) = (point.row(edge(e, 0)) - point.row(edge(e, 1))).transpose() / length_unit;
}

}  // namespace toile::prior

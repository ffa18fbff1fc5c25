#include "evaluate/strain_colour.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "files/mesh_file.h"

namespace toile::evaluate {

Eigen::RowVector3d stretch_colour(double stretch) {
    const Eigen::RowVector3d red(0.86, 0.08, 0.08), blue(0.10, 0.25, 0.90), grey(0.5, 0.5, 0.5), white(1, 1, 1);
    if (std::isnan(stretch)) return grey;
    const double share = std::min(std::abs(stretch - 1) / 0.25, 1.0);
    return white + share * ((stretch < 1 ? blue : red) - white);
}

Eigen::VectorXd shown_stretch(const StrainRest& rest, const std::vector<TriangleStrain>& strain) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(rest.vertex_count), weight = sum;
    for (size_t f = 0; f < strain.size(); ++f) {
        if (!has_strain(strain[f].fault)) continue;
        const Eigen::Vector2d& stretch = strain[f].stretch;
        const double shown = stretch[0] - 1 > 1 - stretch[1] ? stretch[0] : stretch[1];
        const double area = 0.5 / std::abs(rest.frame[f].inverse_edge.determinant());
        for (int corner = 0; corner < 3; ++corner) {
            const int v = rest.mesh_triangle(static_cast<Eigen::Index>(f), corner);
            sum[v] += area * shown;
            weight[v] += area;
        }
    }
    for (Eigen::Index v = 0; v < sum.size(); ++v)
        sum[v] = weight[v] > 0 ? sum[v] / weight[v] : std::numeric_limits<double>::quiet_NaN();
    return sum;
}

void write_coloured_mesh(const std::string& path, const StrainRest& rest, const Positions& position,
                         const std::vector<TriangleStrain>& strain) {
    files::NamedMesh mesh{"strain", rest.mesh_triangle, position};
    const Eigen::VectorXd shown = shown_stretch(rest, strain);
    mesh.color = {1, 1, 1};
    mesh.vertex_color.resize(position.rows(), 3);
    for (Eigen::Index v = 0; v < shown.size(); ++v) mesh.vertex_color.row(v) = stretch_colour(shown[v]);
    files::write_meshes(path, {mesh});
}

}  // namespace toile::evaluate

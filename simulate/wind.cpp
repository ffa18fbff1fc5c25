#include "simulate/wind.h"

#include <Eigen/Geometry>

namespace toile::simulate {

Wind::Wind(const ClothMesh& mesh, const WindOptions& options)
    : mesh_(mesh), options_(options), force_(Positions::Zero(mesh.vertex_count(), 3)) {}

void Wind::linearise(const Positions& x, const Positions* velocity) {
    force_.setZero();
    for (int f = 0; f < mesh_.triangle_count(); ++f) {
        const auto t = mesh_.triangle.row(f);
        const Eigen::Vector3d a = x.row(t[0]), b = x.row(t[1]), c = x.row(t[2]);
        Eigen::Vector3d air = options_.velocity;
        if (velocity) air -= (velocity->row(t[0]) + velocity->row(t[1]) + velocity->row(t[2])).transpose() / 3.0;
        const Eigen::Vector3d area = 0.5 * (b - a).cross(c - a);
        const double speed = air.norm(), size = area.norm();
        if (!(speed > 0.0 && size > 0.0)) continue;
        const Eigen::Vector3d along = air / speed;
        Eigen::Vector3d normal = area / size;
        if (normal.dot(along) < 0.0) normal = -normal;
        const double cosine = normal.dot(along);
        const Eigen::Vector3d force = 0.5 * options_.air_density * size * speed * speed * cosine *
                                      (options_.drag * cosine * along + options_.lift * (normal - cosine * along));
        for (int i = 0; i < 3; ++i) force_.row(t[i]) += force.transpose() / 3.0;
    }
}

}  // namespace toile::simulate

#include "evaluate/derivative_identity.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace toile::evaluate {
namespace {

using View = Eigen::Map<const Eigen::VectorXd>;

View view(std::span<const double> vector) {
    return {vector.data(), static_cast<Eigen::Index>(vector.size())};
}

}  // namespace

std::vector<double> random_direction(std::size_t size, Random& random) {
    std::vector<double> direction(size);
    for (double& x : direction) x = random.normal();
    return direction;
}

std::vector<double> probe_direction(std::span<const double> gradient, int samples, Random& random) {
    std::vector<double> direction = random_direction(gradient.size(), random);
    const std::size_t each = gradient.size() / samples;
    for (int s = 0; s < samples; ++s) {
        Eigen::Map<Eigen::VectorXd> part(direction.data() + s * each, static_cast<Eigen::Index>(each));
        const View along = view(gradient.subspan(s * each, each));
        part.normalize();
        if (along.norm() > 0) part += along / along.norm();
    }
    return direction;
}

double identity_error(std::span<const double> loss_gradient, std::span<const double> tangent,
                      std::span<const double> gradient, std::span<const double> direction) {
    const double forward = view(loss_gradient).dot(view(tangent));
    const double backward = view(gradient).dot(view(direction));
    const double size =
        std::max(view(gradient).norm() * view(direction).norm(), view(loss_gradient).norm() * view(tangent).norm());
    return forward == 0 && backward == 0 ? 0.0 : std::abs(forward - backward) / size;
}

}  // namespace toile::evaluate

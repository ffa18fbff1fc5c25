#include "prior/second_order_cone.h"

#include <algorithm>
#include <cmath>

namespace toile::prior {

double cone_determinant(const ConePoint& q) {
    const double length = q.tail<3>().norm();
    return (q[0] - length) * (q[0] + length);
}

ConePoint cone_product(const ConePoint& q, const ConePoint& p) {
    ConePoint result;
    result[0] = q.dot(p);
    result.tail<3>() = q[0] * p.tail<3>() + p[0] * q.tail<3>();
    return result;
}

ConePoint cone_divide(const ConePoint& q, const ConePoint& p) {
    ConePoint result;
    result[0] = (q[0] * p[0] - q.tail<3>().dot(p.tail<3>())) / cone_determinant(q);
    result.tail<3>() = (p.tail<3>() - result[0] * q.tail<3>()) / q[0];
    return result;
}

double step_to_boundary(const ConePoint& q, const ConePoint& dq, double limit) {
    // The smallest positive root of a α² + 2 b α + c = (q0 + α dq0)² − |q1 + α dq1|², whose c is positive.
    const double a = cone_determinant(dq);
    const double b = q[0] * dq[0] - q.tail<3>().dot(dq.tail<3>());
    const double c = cone_determinant(q);
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0) return limit;
    const double root = std::sqrt(discriminant);
    if (b < 0.0) return std::min(limit, c / (root - b));
    return a < 0.0 ? std::min(limit, -(b + root) / a) : limit;
}

ConeScaling ConeScaling::of(const ConePoint& s, const ConePoint& z) {
    const double s_root = std::sqrt(cone_determinant(s)), z_root = std::sqrt(cone_determinant(z));
    const ConePoint s_unit = s / s_root, z_unit = z / z_root;
    const double gamma = std::sqrt(0.5 * (1.0 + s_unit.dot(z_unit)));
    ConeScaling scaling;
    scaling.eta = std::sqrt(s_root / z_root);
    scaling.w1 = (s_unit.tail<3>() - z_unit.tail<3>()) / (2.0 * gamma);
    scaling.w0 = std::sqrt(1.0 + scaling.w1.squaredNorm());
    return scaling;
}

ConePoint ConeScaling::apply(const ConePoint& x) const {
    const double along = w1.dot(x.tail<3>());
    ConePoint result;
    result[0] = eta * (w0 * x[0] + along);
    result.tail<3>() = eta * (x.tail<3>() + (x[0] + along / (1.0 + w0)) * w1);
    return result;
}

ConePoint ConeScaling::unapply(const ConePoint& x) const {
    const double along = w1.dot(x.tail<3>());
    ConePoint result;
    result[0] = (w0 * x[0] - along) / eta;
    result.tail<3>() = (x.tail<3>() + (along / (1.0 + w0) - x[0]) * w1) / eta;
    return result;
}

}  // namespace toile::prior

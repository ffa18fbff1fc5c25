#include "bench/figures.h"

#include <Eigen/QR>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace toile::bench {

std::string number(double value, int digits) {
    if (std::isnan(value)) return "";
    std::ostringstream text;
    text << std::setprecision(digits) << value;
    return text.str();
}

files::Metric metric(const std::string& name, double value, const std::string& unit, double tolerance,
                     files::MetricDirection direction) {
    files::Metric one;
    one.name = name;
    one.value = value;
    one.unit = unit;
    one.direction = direction;
    one.tolerance = tolerance;
    return one;
}

double scaling_exponent(const std::vector<std::pair<double, double>>& size_and_time) {
    const auto count = static_cast<Eigen::Index>(size_and_time.size());
    if (count < 2) return no_number;
    Eigen::MatrixX2d line(count, 2);
    Eigen::VectorXd time(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        line.row(k) << 1.0, std::log(size_and_time[k].first);
        time[k] = std::log(size_and_time[k].second);
    }
    const Eigen::VectorXd fit = line.colPivHouseholderQr().solve(time);
    return fit[1];
}

}  // namespace toile::bench

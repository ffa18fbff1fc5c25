#include "evaluate/mu_global.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

namespace toile::evaluate {
namespace {

constexpr double width = 0.01;  // of the interval of log μ that holds the root in the end: a hundredth of μ
constexpr int most_evaluations = 20;
constexpr double hopeless = 9.0;  // times the least squared error: the scan ends there

/// The loss along log μ, all vertices alike.
class Line {
  public:
    Line(MuLoss& loss, double unit, const std::function<void()>& evaluated)
        : loss_(loss), unit_(unit), evaluated_(evaluated) {}

    double squared_error(double x) {
        evaluated_();
        return loss_(constant(x), false).squared_error;
    }
    /// Of the relative loss, by x.
    double derivative(double x) {
        evaluated_();
        const MuLoss::Value value = loss_(constant(x));
        left_out = std::max(left_out, value.left_out);
        without_derivative = without_derivative || value.left_out == loss_.sample_count();
        history.push_back({std::exp(x), std::sqrt(value.squared_error), value.squared_error / unit_});
        slope.push_back(value.gradient.sum() / unit_);
        return slope.back();
    }

    std::vector<MuStep> history;
    std::vector<double> slope;
    int left_out = 0;
    bool without_derivative = false;  ///< at some place, of all samples

  private:
    Eigen::VectorXd constant(double x) const { return Eigen::VectorXd::Constant(loss_.vertex_count(), x); }

    MuLoss& loss_;
    double unit_;
    const std::function<void()>& evaluated_;
};

/// The best of a place a decade, from the upper bound down to where the error is many times the least: soft springs
/// let the cloth drift, ever further and at ever greater cost.
double scanned(Line& line, double low, double high) {
    const int steps = std::max(1, static_cast<int>(std::ceil((high - low) / std::log(10.0) - 1e-9)));
    double best = high, least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= steps; ++k) {
        const double x = k == steps ? low : high + (low - high) * k / steps, error = line.squared_error(x);
        if (error < least) {
            least = error;
            best = x;
        }
        if (error > hopeless * least) break;
    }
    return best;
}

/// Of the places where the derivative is known, that where it is closest to zero.
void take_flattest(const Line& line, MuGlobalFit& fit) {
    const auto closest = std::min_element(line.slope.begin(), line.slope.end(),
                                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    fit.mu = line.history[static_cast<size_t>(closest - line.slope.begin())].mu;
}

/// Walks downhill from x, a decade a step, until the derivative changes its sign; then finds the root between.
MuStatus descend(Line& line, double x, const MuFitOptions& options, MuGlobalFit& fit) {
    const double low = std::log(options.low), high = std::log(options.high);
    double slope = line.derivative(x);
    if (line.without_derivative) return MuStatus::no_derivative;
    const double direction = slope > 0.0 ? -1.0 : 1.0;
    double before = x, slope_before = slope;
    while (slope * direction < 0.0) {
        const double bound = direction > 0.0 ? high : low;
        if (x == bound) {
            fit.mu = direction > 0.0 ? options.high : options.low;
            return direction > 0.0 ? MuStatus::at_upper_bound : MuStatus::at_lower_bound;
        }
        before = x;
        slope_before = slope;
        x = std::clamp(x + direction * std::log(10.0), low, high);
        slope = line.derivative(x);
        if (line.without_derivative) return MuStatus::no_derivative;
    }
    if (slope != 0.0 && slope_before != 0.0) {
        const bool ordered = before < x;
        auto evaluations = static_cast<std::uintmax_t>(most_evaluations);
        boost::math::tools::toms748_solve([&line](double at) { return line.derivative(at); }, ordered ? before : x,
                                          ordered ? x : before, ordered ? slope_before : slope,
                                          ordered ? slope : slope_before,
                                          [](double a, double b) { return b - a < width; }, evaluations);
    }
    take_flattest(line, fit);
    return MuStatus::converged;
}

}  // namespace

MuGlobalFit fit_global_mu(MuLoss& loss, MuLoss& scan, const MuFitOptions& options, double unit,
                          const std::function<void()>& evaluated, int& left_out) {
    const double low = std::log(options.low), high = std::log(options.high);
    MuGlobalFit fit;
    Line coarse(scan, unit, evaluated), line(loss, unit, evaluated);
    const double start = scanned(coarse, low, high);
    fit.mu = std::exp(start);
    fit.status = descend(line, start, options, fit);
    fit.mu = std::clamp(fit.mu, options.low, options.high);
    fit.history = line.history;
    left_out = std::max(left_out, line.left_out);
    return fit;
}

}  // namespace toile::evaluate

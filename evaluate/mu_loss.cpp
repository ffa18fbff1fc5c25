#include "evaluate/mu_loss.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

prior::QuasistaticOptions options_of(double tolerance) {
    prior::QuasistaticOptions options;
    options.tolerance = tolerance;
    return options;
}

/// Mean over vertices of |a − b|² [m²]; NaN of nothing.
double mean_squared_distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return a.empty() ? std::numeric_limits<double>::quiet_NaN() : 3.0 * sum / static_cast<double>(a.size());
}

}  // namespace

MuLoss::MuLoss(prior::QuasistaticModel model, double tolerance, ClothPairs pairs, int jobs)
    : prior_(std::move(model), options_of(tolerance)), workspace_(prior_, jobs), pairs_(std::move(pairs)) {
    const size_t size = 3 * static_cast<size_t>(vertex_count());
    if (pairs_.predicted.size() % size != 0 || pairs_.target.size() != pairs_.predicted.size())
        throw Error("the predicted and true positions do not fit the mesh");
    samples_ = static_cast<int>(pairs_.predicted.size() / size);
}

MuLoss::Value MuLoss::operator()(const Eigen::VectorXd& log_mu, bool with_gradient) {
    prior_.set_mu(log_mu.array().exp().matrix());
    prior_.project(pairs_.predicted, solution_, workspace_);
    Value value;
    value.squared_error = mean_squared_distance(solution_.position, pairs_.target);
    if (with_gradient) {
        add_gradient(value);
        value.gradient.array() *= log_mu.array().exp();
    }
    return value;
}

/// Fills in the derivative by μ.
void MuLoss::add_gradient(Value& value) {
    const Eigen::Index vertices = vertex_count();
    const double scale = 2.0 / (static_cast<double>(samples_) * static_cast<double>(vertices));
    loss_gradient_.resize(pairs_.target.size());
    for (size_t i = 0; i < loss_gradient_.size(); ++i)
        loss_gradient_[i] = scale * (solution_.position[i] - pairs_.target[i]);
    prior_.backward(pairs_.predicted, solution_, loss_gradient_, gradient_, workspace_);
    value.gradient.setZero(vertices);
    for (int i = 0; i < samples_; ++i) {
        const Eigen::Map<const Eigen::VectorXd> part(gradient_.mu_vertex.data() + vertices * i, vertices);
        const prior::DerivativeReport& report = gradient_.report[static_cast<size_t>(i)];
        if (solution_.report[static_cast<size_t>(i)].status == prior::Status::converged &&
            report.status == prior::Status::converged && report.positive_definite && part.allFinite())
            value.gradient += part;
        else
            ++value.left_out;
    }
}

double MuLoss::predicted_squared_error() const {
    return mean_squared_distance(pairs_.predicted, pairs_.target);
}

ClothPairs MuLoss::some(int count) const {
    const auto size = static_cast<std::ptrdiff_t>(3 * static_cast<size_t>(vertex_count()));
    const int wanted = std::min(count, samples_);
    ClothPairs part;
    for (int k = 0; k < wanted; ++k) {
        const std::ptrdiff_t first = size * (static_cast<std::ptrdiff_t>(k) * samples_ / wanted);
        part.predicted.insert(part.predicted.end(), pairs_.predicted.begin() + first,
                              pairs_.predicted.begin() + first + size);
        part.target.insert(part.target.end(), pairs_.target.begin() + first, pairs_.target.begin() + first + size);
    }
    return part;
}

}  // namespace toile::evaluate

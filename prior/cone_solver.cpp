#include "prior/cone_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "prior/cone_derivative.h"
#include "prior/cone_interior_point.h"
#include "prior/cone_polish.h"

namespace toile::prior {

struct ConeSolver::Workspace::Buffers {
    ConeInteriorPoint interior_point;
    ConeIterate iterate;

    explicit Buffers(const InextensibilityModel& model) : interior_point(model.edge, model.vertex_count) {}
};

ConeSolver::ConeSolver(const InextensibilityModel& model) : model_(model) {}

ConeSolver::Workspace::Workspace(const ConeSolver& solver) : buffers_(std::make_unique<Buffers>(solver.model_)) {}
ConeSolver::Workspace::~Workspace() = default;
ConeSolver::Workspace::Workspace(Workspace&&) noexcept = default;

namespace {

constexpr double kFirstPolish = 1e-5;  // residual at which Newton's method on the taut edges is first tried
constexpr int kPolishSteps = 30;
constexpr double kRounding = 1e-15;  // of a coordinate, relative
constexpr double kPolished = 1e-13;  // residual below which nothing is left to gain

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

bool is_finite(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

void reject(std::span<double> first, std::span<double> second) {
    std::fill(first.begin(), first.end(), std::numeric_limits<double>::quiet_NaN());
    std::fill(second.begin(), second.end(), std::numeric_limits<double>::quiet_NaN());
}

/// λ_e: what of z_e¹ pulls along the edge.
void multipliers_of(const ConeIterate& iterate, Eigen::VectorXd& lambda) {
    lambda.resize(iterate.s.cols());
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        const Eigen::Vector3d vector = iterate.s.col(e).tail<3>();
        const double length = vector.norm();
        lambda[e] = length > 0.0 ? std::max(0.0, -iterate.z.col(e).tail<3>().dot(vector) / length) : 0.0;
    }
}

/// The best solution seen so far, by the residual that the contract defines, in the caller's units.
class Best {
  public:
    Best(const InextensibilityModel& model, std::span<const double> predicted, std::span<double> position,
         std::span<double> multiplier)
        : model_(model),
          predicted_(predicted),
          position_(position),
          multiplier_(multiplier),
          new_position_(position.size()),
          new_multiplier_(multiplier.size()) {
        fall_back();
        predicted_residual_ = inextensibility_residual(model, predicted, position, multiplier);
    }

    double residual() const { return std::min(residual_, predicted_residual_); }
    /// Of the candidates alone.
    double solved_residual() const { return residual_; }
    /// Whether no edge of the prediction is longer than its limit, but for the rounding of its coordinates.
    bool prediction_is_solution() const {
        double largest = 0.0;
        for (double x : predicted_) largest = std::max(largest, std::abs(x));
        return model_.edge.rows() == 0 ||
               predicted_residual_ <= kRounding * (1.0 + largest / model_.edge_max_length.minCoeff());
    }
    /// To the prediction without multipliers, where that is better than every candidate.
    void finish() {
        if (predicted_residual_ < residual_) fall_back();
    }

    /// The candidate's residual.
    double consider(const ConeProgram& program, const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) {
        for (size_t i = 0; i < position_.size(); ++i)
            new_position_[i] = predicted_[i] + program.length_unit * u[static_cast<Eigen::Index>(i)];
        for (size_t e = 0; e < multiplier_.size(); ++e)
            new_multiplier_[e] = program.force_unit() * lambda[static_cast<Eigen::Index>(e)];
        const double residual = inextensibility_residual(model_, predicted_, new_position_, new_multiplier_);
        if (residual < residual_) {
            residual_ = residual;
            std::copy(new_position_.begin(), new_position_.end(), position_.begin());
            std::copy(new_multiplier_.begin(), new_multiplier_.end(), multiplier_.begin());
        }
        return residual;
    }

  private:
    void fall_back() {
        std::copy(predicted_.begin(), predicted_.end(), position_.begin());
        std::fill(multiplier_.begin(), multiplier_.end(), 0.0);
    }

    const InextensibilityModel& model_;
    std::span<const double> predicted_;
    std::span<double> position_, multiplier_;
    std::vector<double> new_position_, new_multiplier_;
    double predicted_residual_ = 0.0;
    double residual_ = std::numeric_limits<double>::infinity();
};

/// Newton steps from an interior point, as long as they gain.
void polish(const ConeProgram& program, ConeKkt& kkt, Eigen::VectorXd u, Eigen::VectorXd lambda, bool by_largest,
            int max_iterations, Best& best, Report& report) {
    ConePolish newton(kkt, program, by_largest);
    double smallest = std::numeric_limits<double>::infinity();
    int failures = 0;
    for (int k = 0; k < kPolishSteps && failures < 3 && best.solved_residual() > kPolished; ++k) {
        if (report.iterations >= max_iterations) return;
        ++report.iterations;
        if (!newton.step(u, lambda, report)) return;
        const double residual = best.consider(program, u, lambda);
        if (!std::isfinite(residual)) return;
        failures = residual < 0.5 * smallest ? 0 : failures + 1;
        smallest = std::min(smallest, residual);
    }
}

/// Interior-point steps, and a polish whenever a tenth of the last one's residual is reached.
void solve(const ConeProgram& program, ConeInteriorPoint& interior_point, ConeIterate& iterate,
           const InextensibilityOptions& options, Best& best, Report& report) {
    if (!interior_point.start(program, iterate, report)) return;
    Eigen::VectorXd lambda;
    double next_polish = kFirstPolish;
    bool by_largest = true;
    for (bool going = true; going;) {
        multipliers_of(iterate, lambda);
        const double residual = best.consider(program, iterate.u, lambda);
        if (residual <= next_polish) {
            polish(program, interior_point.kkt(), iterate.u, lambda, by_largest, options.max_iterations, best, report);
            by_largest = !by_largest;
            next_polish = 0.1 * residual;
        }
        if (best.solved_residual() <= options.tolerance || report.iterations >= options.max_iterations) return;
        ++report.iterations;
        going = interior_point.step(program, iterate, report);
    }
    for (int k = 0; k < 2 && best.solved_residual() > options.tolerance; ++k)
        polish(program, interior_point.kkt(), iterate.u, lambda, k == 0, options.max_iterations, best, report);
}

}  // namespace

Report ConeSolver::project(std::span<const double> predicted, std::span<double> position, std::span<double> multiplier,
                           const InextensibilityOptions& options, Workspace& workspace) const {
    const auto begin = Clock::now();
    Report report;
    if (is_finite(predicted)) {
        Best best(model_, predicted, position, multiplier);
        if (!best.prediction_is_solution()) {
            ConeProgram program(model_);
            program.set_predicted(predicted);
            solve(program, workspace.buffers_->interior_point, workspace.buffers_->iterate, options, best, report);
        }
        best.finish();
        report.residual = best.residual();
        report.status = report.residual <= options.tolerance ? Status::converged : Status::accuracy_not_reached;
    } else {
        reject(position, multiplier);
        report.residual = std::numeric_limits<double>::quiet_NaN();
    }
    report.seconds = seconds_since(begin);
    return report;
}

Report ConeSolver::project(std::span<const double> predicted, std::span<double> position, std::span<double> multiplier,
                           const InextensibilityOptions& options) const {
    Workspace workspace(*this);
    return project(predicted, position, multiplier, options, workspace);
}

DerivativeReport ConeSolver::backward(std::span<const double> position, std::span<const double> multiplier,
                                      std::span<const double> loss_gradient, std::span<double> predicted_gradient,
                                      std::span<double> edge_max_length_gradient) const {
    const auto begin = Clock::now();
    DerivativeReport report;
    if (is_finite(position) && is_finite(multiplier) && is_finite(loss_gradient)) {
        ConeDerivative derivative(model_, position, multiplier);
        report = derivative.backward(loss_gradient, predicted_gradient, edge_max_length_gradient);
    } else {
        reject(predicted_gradient, edge_max_length_gradient);
    }
    report.seconds = seconds_since(begin);
    return report;
}

DerivativeReport ConeSolver::tangent(std::span<const double> position, std::span<const double> multiplier,
                                     std::span<const double> predicted_change,
                                     std::span<const double> edge_max_length_change,
                                     std::span<double> position_change) const {
    const auto begin = Clock::now();
    DerivativeReport report;
    if (is_finite(position) && is_finite(multiplier) && is_finite(predicted_change) &&
        is_finite(edge_max_length_change)) {
        ConeDerivative derivative(model_, position, multiplier);
        report = derivative.tangent(predicted_change, edge_max_length_change, position_change);
    } else {
        reject(position_change, {});
    }
    report.seconds = seconds_since(begin);
    return report;
}

}  // namespace toile::prior

#include "prior/cone_interior_point.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace toile::prior {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStartStretch = 0.9;      // of the limit, of the longest edge of the elastic start
constexpr int kMaxStarts = 60;             // its springs' force grows at least fourfold with each
constexpr double kStepBack = 0.99;         // of the way to the boundary
constexpr double kShortestStep = 1e-8;     // a shorter one is a standstill
constexpr double kCarriedStiffness = 1.0;  // beyond this one, an edge's extra unknown carries its force

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// B_e x.
Eigen::Vector3d difference(const Edges& edge, Eigen::Index e, const Eigen::VectorXd& x) {
    return x.segment<3>(3 * edge(e, 0)) - x.segment<3>(3 * edge(e, 1));
}

/// x += B_eᵀ v.
void add_pull(const Edges& edge, Eigen::Index e, const Eigen::Vector3d& v, Eigen::VectorXd& x) {
    x.segment<3>(3 * edge(e, 0)) += v;
    x.segment<3>(3 * edge(e, 1)) -= v;
}

void set_primal(const ConeProgram& program, ConeIterate& iterate) {
    for (Eigen::Index e = 0; e < program.edge.rows(); ++e) {
        iterate.s(0, e) = program.limit[e];
        iterate.s.col(e).tail<3>() = program.edge_vector.col(e) + difference(program.edge, e, iterate.u);
    }
}

double largest_stretch(const ConeIterate& iterate) {
    return (iterate.s.bottomRows<3>().colwise().norm().array() / iterate.s.row(0).array()).maxCoeff();
}

/// False once rounding has carried a point out of its cone: the end of what can be resolved.
bool inside(const ConeIterate& iterate) {
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e)
        if (!(cone_determinant(iterate.s.col(e)) > 0.0 && cone_determinant(iterate.z.col(e)) > 0.0)) return false;
    return true;
}

}  // namespace

ConeInteriorPoint::ConeInteriorPoint(const Edges& edge, int vertex_count)
    : kkt_(edge, vertex_count), scaling_(static_cast<size_t>(edge.rows())) {}

bool ConeInteriorPoint::start(const ConeProgram& program, ConeIterate& iterate, Report& report) {
    const Eigen::Index coordinates = 3 * program.stiffness.size(), edges = program.edge.rows();
    iterate.s.resize(4, edges);
    iterate.z.resize(4, edges);
    double force = 1.0;
    for (int attempt = 0; attempt < kMaxStarts; ++attempt) {
        kkt_.begin(program.stiffness);
        right_.setZero(kkt_.size());
        for (Eigen::Index e = 0; e < edges; ++e) {
            const double stiffness = force / program.limit[e];
            kkt_.set_edge(e, stiffness, Eigen::Vector3d::Zero(), 1.0);
            add_pull(program.edge, e, -stiffness * program.edge_vector.col(e), right_);
        }
        const auto before = Clock::now();
        const bool factored = kkt_.factor();
        report.seconds_factor += seconds_since(before);
        if (!factored) return false;
        kkt_.solve(right_, solution_);
        iterate.u = solution_.head(coordinates);
        set_primal(program, iterate);
        const double stretch = largest_stretch(iterate);
        if (!std::isfinite(stretch)) return false;
        if (stretch < kStartStretch) {
            iterate.z.row(0).setConstant(force);
            for (Eigen::Index e = 0; e < edges; ++e)
                iterate.z.col(e).tail<3>() = -force / program.limit[e] * iterate.s.col(e).tail<3>();
            return true;
        }
        force *= std::max(4.0, 2.0 * stretch);
    }
    return false;
}

void ConeInteriorPoint::assemble(const ConeProgram& program, const ConeIterate& iterate) {
    lambda_.resize(4, iterate.s.cols());
    imbalance_.resize(3 * program.stiffness.size());
    for (Eigen::Index i = 0; i < imbalance_.size(); ++i) imbalance_[i] = program.stiffness[i / 3] * iterate.u[i];
    kkt_.begin(program.stiffness);
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        ConeScaling& w = scaling_[static_cast<size_t>(e)];
        w = ConeScaling::of(iterate.s.col(e), iterate.z.col(e));
        lambda_.col(e) = w.apply(iterate.z.col(e));
        add_pull(program.edge, e, -iterate.z.col(e).tail<3>(), imbalance_);
        const double transverse = 1.0 / (w.eta * w.eta);
        const double length = w.w1.norm();
        const double along = 2.0 * length * length * transverse;
        const double compliance = 1.0 / (along + kCarriedStiffness);
        const double row = length > 0.0 ? std::sqrt(along * compliance) / length : 0.0;
        kkt_.set_edge(e, transverse, row * w.w1, compliance);
    }
}

void ConeInteriorPoint::direction(const ConeProgram& program, const ConeIterate& iterate,
                                  const Eigen::Matrix4Xd& scaled_right) {
    right_.setZero(kkt_.size());
    right_.head(imbalance_.size()) = -imbalance_;
    dz_.resize(4, iterate.s.cols());
    ds_.resize(4, iterate.s.cols());
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        dz_.col(e) = scaling_[static_cast<size_t>(e)].unapply(scaled_right.col(e));
        add_pull(program.edge, e, dz_.col(e).tail<3>(), right_);
    }
    kkt_.solve(right_, solution_);
    du_ = solution_.head(imbalance_.size());
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        const ConeScaling& w = scaling_[static_cast<size_t>(e)];
        const double transverse = 1.0 / (w.eta * w.eta);
        const Eigen::Vector3d change = difference(program.edge, e, du_);
        // Along w1 the extra unknown knows the force better than the change of length, which is nearly zero, times the
        // stiffness, which is nearly infinite.
        const double length = w.w1.norm();
        const double along = 2.0 * length * length * transverse;
        const double force = length == 0.0 ? 0.0
                             : along > kCarriedStiffness
                                 ? std::sqrt(along / (along + kCarriedStiffness)) * solution_[imbalance_.size() + e]
                                 : along * w.w1.dot(change) / length;
        ds_(0, e) = 0.0;
        ds_.col(e).tail<3>() = change;
        dz_.col(e).tail<3>() -= transverse * change;
        if (length > 0.0) {
            dz_(0, e) += w.w0 / length * force;
            dz_.col(e).tail<3>() -= force / length * w.w1;
        }
    }
}

double ConeInteriorPoint::longest_step(const ConeIterate& iterate) const {
    double step = 1.0 / kStepBack;
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        step = step_to_boundary(iterate.s.col(e), ds_.col(e), step);
        step = step_to_boundary(iterate.z.col(e), dz_.col(e), step);
    }
    return std::min(1.0, kStepBack * step);
}

double ConeInteriorPoint::predictor(const ConeProgram& program, const ConeIterate& iterate) {
    right_scaled_ = -lambda_;
    direction(program, iterate, right_scaled_);
    return longest_step(iterate);
}

void ConeInteriorPoint::corrector(const ConeProgram& program, const ConeIterate& iterate, double affine_step) {
    const double centring = std::pow(1.0 - affine_step, 3) * iterate.mean_product();
    for (Eigen::Index e = 0; e < iterate.s.cols(); ++e) {
        const ConeScaling& w = scaling_[static_cast<size_t>(e)];
        ConePoint right =
            -cone_product(lambda_.col(e), lambda_.col(e)) - cone_product(w.unapply(ds_.col(e)), w.apply(dz_.col(e)));
        right[0] += centring;
        right_scaled_.col(e) = cone_divide(lambda_.col(e), right);
    }
    direction(program, iterate, right_scaled_);
}

bool ConeInteriorPoint::step(const ConeProgram& program, ConeIterate& iterate, Report& report) {
    auto before = Clock::now();
    assemble(program, iterate);
    report.seconds_assembly += seconds_since(before);
    before = Clock::now();
    const bool factored = kkt_.factor();
    report.seconds_factor += seconds_since(before);
    if (!factored) return false;

    before = Clock::now();
    const double affine_step = predictor(program, iterate);
    corrector(program, iterate, affine_step);
    report.seconds_solve += seconds_since(before);
    const double length = longest_step(iterate);
    if (!du_.allFinite() || !dz_.allFinite() || length < kShortestStep) return false;
    iterate.u += length * du_;
    iterate.z += length * dz_;
    set_primal(program, iterate);
    return inside(iterate);
}

}  // namespace toile::prior

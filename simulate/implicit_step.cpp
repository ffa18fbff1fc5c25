#include "simulate/implicit_step.h"

#include <algorithm>
#include <cmath>

#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// No vertex moves further in one iteration than limbs are thick, or it could pass through one unseen [m].
constexpr double largest_move = 0.03;
constexpr double sufficient_decrease = 1e-4;
constexpr int most_halvings = 12;
/// A step may be lengthened up to this many times Newton's: the projected Hessian is too stiff along a fold that is
/// forming, and an energy costs a tenth of a factorisation.
constexpr double longest_share = 16.0;

}  // namespace

ImplicitStep::ImplicitStep(const ClothMesh& mesh, const Elasticity& elasticity,
                           std::shared_ptr<const BlockSymbolic> symbolic, const std::vector<int>& pinned,
                           std::vector<Contact*> contacts, double damping)
    : mesh_(mesh),
      elasticity_(elasticity),
      pinned_(static_cast<size_t>(mesh.vertex_count()), false),
      contacts_(std::move(contacts)),
      damping_(damping),
      hessian_(symbolic),
      cholesky_(symbolic),
      gradient_(mesh.vertex_count(), 3),
      direction_(mesh.vertex_count(), 3),
      trial_(mesh.vertex_count(), 3) {
    for (int v : pinned) pinned_[v] = true;
}

double ImplicitStep::energy(const Target& target, const Positions& x) const {
    const double h = target.time_step;
    const Eigen::VectorXd inertia = (x - *target.inertial).rowwise().squaredNorm();
    const Eigen::VectorXd drag = (x - *target.carried).rowwise().squaredNorm();
    double energy = mesh_.mass.dot(0.5 / (h * h) * inertia + 0.5 * damping_ / h * drag) + elasticity_.energy(x);
    for (const Contact* contact : contacts_) energy += contact->energy(x);
    return energy;
}

void ImplicitStep::clear_pinned(Positions& rows) const {
    for (int v = 0; v < rows.rows(); ++v)
        if (pinned_[v]) rows.row(v).setZero();
}

void ImplicitStep::gradient_of(const Target& target, const Positions& x) {
    const double h = target.time_step;
    gradient_.noalias() = mesh_.mass.asDiagonal() * ((x - *target.inertial) / (h * h));
    gradient_ += mesh_.mass.asDiagonal() * ((damping_ / h) * (x - *target.carried));
    elasticity_.add_gradient(x, gradient_);
    for (Contact* contact : contacts_) contact->add_gradient(gradient_);
    clear_pinned(gradient_);
}

double ImplicitStep::static_residual(const Positions& x) {
    gradient_.setZero();
    elasticity_.add_gradient(x, gradient_);
    for (Contact* contact : contacts_) {
        contact->linearise(x);
        contact->add_gradient(gradient_);
    }
    clear_pinned(gradient_);
    return gradient_.norm();
}

bool ImplicitStep::newton_direction(const Positions& x, double inertia, DrapeReport& report) {
    {
        const Stopwatch watch(report.assembly_seconds);
        for (int v = 0; v < mesh_.vertex_count(); ++v) hessian_.add_identity(v, inertia * mesh_.mass[v]);
        elasticity_.add_hessian(x, hessian_);
        hessian_.fix(pinned_);
    }
    const Stopwatch watch(report.factor_seconds);
    direction_ = -gradient_;
    bool definite = cholesky_.factor_and_solve(hessian_.data(), direction_.data()).all();
    // Rounding can spoil a matrix that is nearly singular: a growing shift mends it.
    for (double shift = 1e-3 * inertia; !definite && shift < 1e12 * inertia; shift *= 10.0) {
        for (int v = 0; v < mesh_.vertex_count(); ++v) hessian_.add_identity(v, shift * mesh_.mass[v]);
        direction_ = -gradient_;
        definite = cholesky_.factor_and_solve(hessian_.data(), direction_.data()).all();
    }
    return definite;
}

double ImplicitStep::lengthen(const Target& target, const Positions& x, double share, double longest,
                              double energy_there) {
    const double cap = contacts_.empty() ? longest_share : std::min(longest_share, largest_move / longest);
    while (2.0 * share <= cap) {
        trial_ = x + 2.0 * share * direction_;
        const double further = energy(target, trial_);
        if (!(further < energy_there)) break;
        energy_there = further;
        share *= 2.0;
    }
    return share;
}

ImplicitStep::Iteration ImplicitStep::iterate(const Target& target, Positions& x, DrapeReport& report) {
    constexpr Iteration failed{most_halvings, 0.0, 0.0};
    ++report.iterations;
    const double inertia = 1.0 / (target.time_step * target.time_step) + damping_ / target.time_step;
    {
        const Stopwatch watch(report.contact_seconds);
        for (Contact* contact : contacts_) contact->linearise(x);
        hessian_.set_zero();
        gradient_of(target, x);
        for (Contact* contact : contacts_) contact->add_hessian(hessian_);
    }
    if (!gradient_.allFinite()) return failed;
    if (!newton_direction(x, inertia, report)) return failed;
    const Stopwatch watch(report.line_search_seconds);
    const double slope = gradient_.cwiseProduct(direction_).sum();
    const double longest = std::sqrt(direction_.rowwise().squaredNorm().maxCoeff());
    if (!(slope < 0.0) || !std::isfinite(longest)) return failed;
    const double before = energy(target, x);
    double share = contacts_.empty() ? 1.0 : std::min(1.0, largest_move / longest);
    for (int halving = 0; halving < most_halvings; ++halving, share *= 0.5) {
        trial_ = x + share * direction_;
        // Near the minimum rounding hides the decrease: a change within rounding of Φ counts as one.
        const double after = energy(target, trial_);
        if (after <= before + sufficient_decrease * share * slope + 1e-14 * std::abs(before)) {
            if (halving == 0) share = lengthen(target, x, share, longest, after);
            x += share * direction_;
            return {halving, share, share * longest};
        }
        ++report.line_search_halvings;
    }
    return failed;
}

}  // namespace toile::simulate

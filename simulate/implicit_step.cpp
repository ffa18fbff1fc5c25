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
/// What a step that led nowhere leaves of the trust region.
constexpr double share_of_failure = 0.1;
/// A step may be lengthened up to this many times Newton's: the projected Hessian is too stiff along a fold that is
/// forming, and an energy costs a tenth of a factorisation.
constexpr double longest_share = 16.0;

}  // namespace

ImplicitStep::ImplicitStep(const ClothMesh& mesh, const Elasticity& elasticity,
                           std::shared_ptr<const BlockSymbolic> symbolic, const std::vector<int>& pinned,
                           std::vector<Contact*> contacts, SelfContact* self_contact, double damping)
    : mesh_(mesh),
      elasticity_(elasticity),
      pinned_(static_cast<size_t>(mesh.vertex_count()), false),
      contacts_(std::move(contacts)),
      self_contact_(self_contact),
      damping_(damping),
      hessian_(std::move(symbolic)),
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
    if (self_contact_) energy += self_contact_->energy(x);
    if (wind_) energy += wind_->energy(x);
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
    if (self_contact_) self_contact_->add_gradient(gradient_);
    if (wind_) wind_->add_gradient(gradient_);
    clear_pinned(gradient_);
}

void ImplicitStep::linearise(const Positions& x, DrapeReport& report) {
    if (linearised_at_.rows() == x.rows() && linearised_at_ == x) return;
    linearised_at_ = x;
    {
        const Stopwatch watch(report.contact_seconds);
        for (Contact* contact : contacts_) contact->linearise(x);
    }
    if (wind_) wind_->linearise(x);
    if (!self_contact_) return;
    const Stopwatch watch(report.self_contact_seconds);
    self_contact_->look_around(x);
    self_contact_->linearise(x);
}

double ImplicitStep::static_residual(const Positions& x, DrapeReport& report) {
    linearise(x, report);
    gradient_.setZero();
    elasticity_.add_gradient(x, gradient_);
    for (Contact* contact : contacts_) contact->add_gradient(gradient_);
    if (self_contact_) self_contact_->add_gradient(gradient_);
    if (wind_) wind_->add_gradient(gradient_);
    clear_pinned(gradient_);
    return gradient_.norm();
}

bool ImplicitStep::newton_direction(const Positions& x, double inertia, DrapeReport& report) {
    {
        const Stopwatch watch(report.assembly_seconds);
        if (self_contact_) hessian_.couple(self_contact_->touching(), self_contact_->nearly_touching());
        BlockValues& own = hessian_.own();
        own.set_zero();
        for (int v = 0; v < mesh_.vertex_count(); ++v) own.add_identity(v, inertia * mesh_.mass[v]);
        elasticity_.add_hessian(x, own);
        for (Contact* contact : contacts_) contact->add_hessian(own);
        hessian_.finish();
        if (self_contact_) self_contact_->add_hessian(hessian_.values());
        hessian_.values().fix(pinned_);
    }
    const Stopwatch watch(report.factor_seconds);
    direction_ = -gradient_;
    bool definite = hessian_.factor_and_solve(direction_.data());
    // Rounding can spoil a matrix that is nearly singular: a growing shift mends it.
    for (double shift = 1e-3 * inertia; !definite && shift < 1e12 * inertia; shift *= 10.0) {
        for (int v = 0; v < mesh_.vertex_count(); ++v) hessian_.values().add_identity(v, shift * mesh_.mass[v]);
        direction_ = -gradient_;
        definite = hessian_.factor_and_solve(direction_.data());
    }
    return definite;
}

void ImplicitStep::go_by_true_curvature(const Positions& x, DrapeReport& report) {
    const Stopwatch watch(report.factor_seconds);
    elasticity_.find_softening(x, softening_);
    const auto multiply = [&](const Positions& way, Positions& product) {
        hessian_.values().multiply(way.data(), product.data());
        elasticity_.add_softened(softening_, way, product);
        clear_pinned(product);
    };
    const auto precondition = [&](const Positions& residual, Positions& way) {
        way = residual;
        hessian_.solve(way.data());
    };
    region_.improve(gradient_, multiply, precondition, direction_);
}

bool ImplicitStep::make_safe(const Positions& x, DrapeReport& report) {
    const Stopwatch watch(report.self_contact_seconds);
    trial_ = direction_;
    if (self_contact_->limit(x, trial_) >= 1.0) return true;
    // Zones that are shortened apart may turn the whole uphill: then everything is shortened alike.
    if (!(gradient_.cwiseProduct(trial_).sum() < 0.0)) {
        trial_ = direction_;
        if (!(self_contact_->limit_alike(x, trial_) > 0.0)) return false;
    }
    direction_ = trial_;
    return true;
}

double ImplicitStep::lengthen(const Target& target, const Positions& x, double share, double longest,
                              double energy_there) {
    const bool free = contacts_.empty() && !self_contact_;
    const double cap = free ? longest_share : std::min(longest_share, largest_move / longest);
    while (2.0 * share <= cap) {
        if (self_contact_) {
            trial_ = 2.0 * share * direction_;
            if (!self_contact_->is_known_safe(x, trial_)) break;
        }
        trial_ = x + 2.0 * share * direction_;
        const double further = energy(target, trial_);
        if (!(further < energy_there)) break;
        energy_there = further;
        share *= 2.0;
    }
    return share;
}

ImplicitStep::Iteration ImplicitStep::descend(const Target& target, Positions& x, DrapeReport& report) {
    constexpr Iteration failed{most_halvings, 0.0, 0.0};
    const Stopwatch watch(report.line_search_seconds);
    double longest = std::sqrt(direction_.rowwise().squaredNorm().maxCoeff());
    if (!std::isfinite(longest)) return failed;
    const bool free = contacts_.empty() && !self_contact_;
    if (!free && longest > largest_move) direction_ *= largest_move / longest;
    if (self_contact_ && !make_safe(x, report)) return failed;
    longest = std::sqrt(direction_.rowwise().squaredNorm().maxCoeff());
    const double slope = gradient_.cwiseProduct(direction_).sum();
    if (!(slope < 0.0)) return failed;
    const double before = energy(target, x);
    double share = 1.0;
    for (int halving = 0; halving < most_halvings; ++halving, share *= 0.5) {
        trial_ = x + share * direction_;
        // Near the minimum rounding hides the decrease: a change within rounding of Φ counts as one.
        const double after = energy(target, trial_);
        if (after <= before + sufficient_decrease * share * slope + 1e-14 * std::abs(before)) {
            if (halving == 0 && !target.true_curvature) share = lengthen(target, x, share, longest, after);
            x += share * direction_;
            return {halving, share, share * longest, before - after};
        }
        ++report.line_search_halvings;
    }
    return failed;
}

ImplicitStep::Iteration ImplicitStep::iterate(const Target& target, Positions& x, DrapeReport& report) {
    constexpr Iteration failed{most_halvings, 0.0, 0.0};
    ++report.iterations;
    const double inertia = 1.0 / (target.time_step * target.time_step) + damping_ / target.time_step;
    linearise(x, report);
    gradient_of(target, x);
    if (!gradient_.allFinite()) return failed;
    if (!newton_direction(x, inertia, report)) return failed;
    if (!target.true_curvature) return descend(target, x, report);
    go_by_true_curvature(x, report);
    const Iteration done = descend(target, x, report);
    region_.learn(done.step_share > 0.0 ? done.step_share : share_of_failure, done.decrease);
    return done;
}

}  // namespace toile::simulate

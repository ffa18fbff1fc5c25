#include "simulate/bullet_solver.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "simulate/contact.h"
#include "simulate/drape_model.h"
#include "simulate/spring_network.h"
#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// Mass of the bodies that stand for a solid's surface at one contact [kg]: so large that the cloth does not move them,
/// so small that the velocity it gives them can be read.
constexpr double surface_mass = 1e6;
/// Speed at which a vertex below the surface is taken back to it [m/s].
constexpr double recovery_speed = 0.5;
/// Velocities are not dropped more often than every so many substeps: chatter of few vertices would else stop all.
constexpr int shortest_swing = 4;
/// A vertex so little above the thickness, over the thickness, is held from coming nearer: otherwise links would pull
/// in what gravity lifts off, in turns.
constexpr double hold = 0.01;
/// Margin of the soft body's own trees [m]: wide, so that they need no work while nobody asks them.
constexpr double tree_margin = 1.0;

btVector3 to_bullet(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}
Eigen::Vector3d to_eigen(const btVector3& v) {
    return {v.x(), v.y(), v.z()};
}

/// One vertex at one solid.
struct Touch {
    double clear = -1.0;        // the vertex cannot touch before it has moved this far from `looked_up` [m]
    Eigen::Vector3d looked_up;  // where that was found
    Eigen::Vector3d local;      // the vertex in its piece's frame, before the solids move
    Eigen::Vector3d surface_velocity = Eigen::Vector3d::Zero();  // relative to the carried frame
    bool touched = false;                                        // in the last substep, with these [N s]
    double normal_impulse = 0.0, tangential_impulse = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double ease = 1.0;  // of the recovery speed
    double grip = 0.0;  // share of the slip that friction took in the last substep
};

using Touches = std::vector<std::vector<Touch>>;  // [solid][vertex]

/// What a rigid contact of the soft body came from, in the order of `m_rcontacts`.
struct ContactSource {
    Touch* touch;
    Eigen::Vector3d normal;
    bool recovering;
};

/// Finds the soft body's contacts with the solids, and weighs them afterwards.
class SolidContactSolver final : public btDefaultSoftBodySolver {
  public:
    SolidContactSolver(const std::vector<Contact*>& contacts, int vertex_count) : contacts_(contacts) {
        for (size_t k = 0; k < contacts.size(); ++k) touch_.emplace_back(static_cast<size_t>(vertex_count));
    }

    using btDefaultSoftBodySolver::processCollision;
    /// The solid's index is the collision object's user index.
    void processCollision(btSoftBody* cloth, const btCollisionObjectWrapper* solid) override;
    void predictMotion(btScalar dt) override {
        source_.clear();
        btDefaultSoftBodySolver::predictMotion(dt);
    }
    void solveConstraints(btScalar dt) override;

    /// The solids have moved, or points are tied to other pieces: look every distance up again.
    void forget_distances();
    /// Remembers where on each piece the vertices are.
    void tie(const Positions& x);
    /// The solids have just moved and would take the cloth to `carried` within h: how their surfaces move beyond that.
    void take_surface_velocities(const Positions& carried, double h);
    void rest_surfaces();

    const Touches& touches() const { return touch_; }
    void set_touches(const Touches& touches) { touch_ = touches; }

  private:
    bool add_contact(btSoftBody& cloth, btSoftBody::Node& node, const Contact& contact, Touch& touch,
                     const Obstacle::Contact& found);
    btRigidBody& surface_body(size_t index);
    static double grip_of(const Touch& touch, double friction, double new_normal, double new_slip);

    std::vector<Contact*> contacts_;
    Touches touch_;
    std::vector<ContactSource> source_;
    std::vector<std::unique_ptr<btRigidBody>> surface_;
};

void SolidContactSolver::forget_distances() {
    for (std::vector<Touch>& touches : touch_)
        for (Touch& touch : touches) touch.clear = -1.0;
}

void SolidContactSolver::tie(const Positions& x) {
    for (size_t k = 0; k < contacts_.size(); ++k)
        for (int v = 0; v < x.rows(); ++v)
            touch_[k][v].local = contacts_[k]->obstacle().to_local(x.row(v).transpose(), contacts_[k]->piece(v));
}

void SolidContactSolver::take_surface_velocities(const Positions& carried, double h) {
    for (size_t k = 0; k < contacts_.size(); ++k)
        for (int v = 0; v < carried.rows(); ++v) {
            Touch& touch = touch_[k][v];
            const Eigen::Vector3d moved = contacts_[k]->obstacle().to_world(touch.local, contacts_[k]->piece(v));
            touch.surface_velocity = (moved - carried.row(v).transpose()) / h;
            touch.ease = 1.0;
        }
}

void SolidContactSolver::rest_surfaces() {
    for (std::vector<Touch>& touches : touch_)
        for (Touch& touch : touches) touch.surface_velocity.setZero();
}

btRigidBody& SolidContactSolver::surface_body(size_t index) {
    while (surface_.size() <= index) {
        // Bullet numbers its rigid bodies with a global counter.
        static std::mutex numbering;
        const std::lock_guard lock(numbering);
        surface_.push_back(std::make_unique<btRigidBody>(surface_mass, nullptr, nullptr));
    }
    return *surface_[index];
}

void SolidContactSolver::processCollision(btSoftBody* cloth, const btCollisionObjectWrapper* solid) {
    const int k = solid->getCollisionObject()->getUserIndex();
    const Contact& contact = *contacts_[k];
    for (int v = 0; v < cloth->m_nodes.size(); ++v) {
        btSoftBody::Node& node = cloth->m_nodes[v];
        if (!(node.m_im > 0.0)) continue;
        Touch& touch = touch_[k][v];
        const Eigen::Vector3d x = to_eigen(node.m_x);
        // A distance changes by no more than its point moves: most vertices need not be looked up.
        if (touch.clear > 0.0 && (x - touch.looked_up).squaredNorm() < touch.clear * touch.clear) {
            touch.touched = false;
            touch.ease = 1.0;
            continue;
        }
        const Obstacle::Contact found = contact.obstacle().sample(x, contact.piece(v));
        touch.clear = found.distance - (1.0 + hold) * contact.options().thickness;
        touch.looked_up = x;
        if (!(touch.clear < 0.0 && found.gradient.squaredNorm() > 0.0 &&
              add_contact(*cloth, node, contact, touch, found)))
            touch.touched = false;
        if (!touch.touched) touch.ease = 1.0;
    }
}

/// Coulomb's law lagged by a substep: the share of the slip that friction may take, so that what it takes is at most
/// its coefficient times the normal impulse. A new contact, of which nothing is known yet, goes by its prediction.
double SolidContactSolver::grip_of(const Touch& touch, double friction, double new_normal, double new_slip) {
    const bool pressed = touch.touched && touch.normal_impulse > 0.0, known = pressed && touch.grip > 0.0;
    const double most = friction * (pressed ? touch.normal_impulse : new_normal);
    const double wanted = known ? touch.tangential_impulse / touch.grip : new_slip;
    return wanted > most ? most / wanted : friction > 0.0 ? 1.0 : 0.0;
}

/// Bullet moves a node in contact, unless it leaves, by −½ n (Δ·n + dp) − grip (Δ − n (Δ·n)), where Δ is its way in
/// this substep relative to the surface, dp = n·x + offset, and the ½ is in the impulse matrix. The offset is such that
/// the normal part takes the node to the thickness exactly; or, from further below, as far as the recovery speed goes.
///
/// A vertex squeezed between two surfaces finds its normal turned round each time one has pushed it to the other: the
/// pushes are halved each time until it rests between them.
bool SolidContactSolver::add_contact(btSoftBody& cloth, btSoftBody::Node& node, const Contact& contact, Touch& touch,
                                     const Obstacle::Contact& found) {
    const double dt = cloth.m_sst.sdt, mass = 1.0 / node.m_im, thickness = contact.options().thickness;
    const Eigen::Vector3d n = found.gradient.normalized(), x = to_eigen(node.m_x), q = to_eigen(node.m_q);
    const double depth = thickness - found.distance;
    const double start = n.dot(q - x) - depth;  // signed distance to the thickness where the substep began
    if (depth < 0.0 && start > hold * thickness) return false;
    if (touch.touched && n.dot(touch.normal) < 0.0) touch.ease *= 0.5;
    touch.normal = n;
    const double recovered = std::min(0.0, start + touch.ease * recovery_speed * dt);
    const double target = start > hold * thickness ? 0.0 : start > 0.0 ? start : recovered;

    const Eigen::Vector3d along = touch.surface_velocity - n * n.dot(touch.surface_velocity);
    const Eigen::Vector3d way = x - q - dt * along;
    const double slip = (way - n * n.dot(way)).norm();
    touch.grip =
        grip_of(touch, contact.options().friction, std::max(0.0, depth + target) * mass / dt, slip * mass / dt);
    touch.touched = true;

    btRigidBody& surface = surface_body(source_.size());
    surface.setLinearVelocity(to_bullet(along));
    btSoftBody::RContact c;
    c.t1.setZero();  // of multibodies: copied along
    c.t2.setZero();
    c.m_cti.m_colObj = &surface;
    c.m_cti.m_normal = to_bullet(n);
    c.m_cti.m_offset = n.dot(q) - 2.0 * (n.dot(x) + depth + target);
    c.m_node = &node;
    const Eigen::Matrix3d impulse = mass / dt * (Eigen::Matrix3d::Identity() - 0.5 * n * n.transpose());
    c.m_c0.setValue(impulse(0, 0), impulse(0, 1), impulse(0, 2), impulse(1, 0), impulse(1, 1), impulse(1, 2),
                    impulse(2, 0), impulse(2, 1), impulse(2, 2));
    c.m_c1.setZero();
    c.m_c2 = node.m_im * dt;
    c.m_c3 = std::pow(1.0 - touch.grip, 1.0 / cloth.m_cfg.piterations);  // each pass takes its part
    c.m_c4 = 1.0;
    cloth.m_rcontacts.push_back(c);
    source_.push_back({&touch, n, start < 0.0});
    return true;
}

void SolidContactSolver::solveConstraints(btScalar dt) {
    btDefaultSoftBodySolver::solveConstraints(dt);
    btSoftBody& cloth = *m_softBodySet[0];
    for (size_t i = 0; i < source_.size(); ++i) {
        const auto& [touch, n, recovering] = source_[i];
        const btSoftBody::RContact& c = cloth.m_rcontacts[static_cast<int>(i)];
        const Eigen::Vector3d along = touch->surface_velocity - n * n.dot(touch->surface_velocity);
        const Eigen::Vector3d impulse = surface_mass * (to_eigen(surface_[i]->getLinearVelocity()) - along);
        const double normal = -n.dot(impulse);
        touch->normal_impulse = std::max(0.0, normal);
        touch->tangential_impulse = (impulse + normal * n).norm();
        const double leaving = n.dot(to_eigen(c.m_node->m_v));
        if (recovering && leaving > 0.0) c.m_node->m_v -= to_bullet(leaving * n);
    }
}

class BulletSolver final : public Solver {
  public:
    BulletSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report);

    void start(const Positions& x) override;
    void follow(const Positions& carried) override;
    void settle() override;
    const Positions& position() const override { return x_; }
    double residual_force() override;
    double largest_speed() override;
    Eigen::VectorXd speeds() override;
    double energy() const override;

  private:
    void add_links();
    void place(const Positions& x);
    void run(int substeps, bool settling);
    void substep();
    void drop_velocities_past_peak();
    void begin_step();
    /// All that a trial run changes.
    struct Snapshot {
        Positions x, velocity_before, before, velocity;
        Touches touches;
        bool stepped;
    };
    Snapshot snapshot() const;
    double net_force() const;  // of the last substep [N]
    void restore(const Snapshot& then);
    double inverse_mass(int v) const { return soft_->m_nodes[v].m_im; }

    const DrapeModel& model_;
    const BulletOptions& options_;
    std::vector<Contact*> contacts_;
    DrapeReport& report_;
    int substeps_;  // in one path step
    double dt_;
    std::vector<Spring> springs_;
    btSoftBodyWorldInfo world_;
    SolidContactSolver solver_;
    std::vector<btCollisionObject> solid_;
    std::unique_ptr<btSoftBody> soft_;
    Positions x_, velocity_before_;
    double kinetic_energy_ = 0.0;  // of the last substep while settling [J]
    int since_drop_ = 0;
    bool stepped_ = false;  // since `start`
};

BulletSolver::BulletSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report)
    : model_(model),
      options_(model.scene.solver.bullet),
      contacts_(contacts),
      report_(report),
      substeps_(std::max(1, static_cast<int>(std::ceil(model.scene.solver.time_step / options_.substep - 1e-9)))),
      dt_(model.scene.solver.time_step / substeps_),
      solver_(contacts, model.scene.mesh.vertex_count()),
      solid_(contacts.size()) {
    const DrapeScene& scene = model.scene;
    springs_ = membrane_springs(scene.mesh, model.topology, model.rest_length, scene.membrane);
    if (scene.bending) {
        const std::vector<Spring> bending = bending_springs(scene.mesh, model.topology, *scene.bending);
        springs_.insert(springs_.end(), bending.begin(), bending.end());
    }
    world_.m_gravity = to_bullet(model.scene.solver.gravity);
    for (size_t k = 0; k < solid_.size(); ++k) solid_[k].setUserIndex(static_cast<int>(k));
}

void BulletSolver::add_links() {
    const double h2 = dt_ * dt_;
    for (const Spring& spring : springs_) {
        soft_->appendLink(spring.first, spring.second);
        btSoftBody::Link& link = soft_->m_links[soft_->m_links.size() - 1];
        const double w = inverse_mass(spring.first) + inverse_mass(spring.second);
        const double share = 1.0 - std::pow(1.0 + spring.stiffness * h2 * w, -1.0 / options_.position_iterations);
        link.m_rl = spring.rest_length;
        link.m_c1 = spring.rest_length * spring.rest_length;
        link.m_c0 = w > 0.0 ? w / share : 0.0;  // as Bullet's updateLinkConstants, with a kLST for each link
    }
}

void BulletSolver::start(const Positions& x) {
    x_ = x;
    velocity_before_ = Positions::Zero(x.rows(), 3);
    const DrapeScene& scene = model_.scene;
    const int count = static_cast<int>(x.rows());
    std::vector<btVector3> position(static_cast<size_t>(count));
    std::vector<btScalar> mass(static_cast<size_t>(count));
    for (int v = 0; v < count; ++v) {
        position[v] = to_bullet(x.row(v).transpose());
        mass[v] = scene.mesh.mass[v];
    }
    for (int v : scene.pinned) mass[v] = 0.0;
    soft_ = std::make_unique<btSoftBody>(&world_, count, position.data(), mass.data());
    soft_->getCollisionShape()->setMargin(tree_margin);
    soft_->m_cfg.piterations = options_.position_iterations;
    soft_->m_cfg.kDP = scene.solver.damping * dt_ / (1.0 + scene.solver.damping * dt_);
    // Contact has the last word of each pass.
    soft_->m_cfg.m_psequence.clear();
    soft_->m_cfg.m_psequence.push_back(btSoftBody::ePSolver::Linear);
    soft_->m_cfg.m_psequence.push_back(btSoftBody::ePSolver::RContacts);
    add_links();
    soft_->m_bUpdateRtCst = false;  // or Bullet would take rest lengths from the positions

    btAlignedObjectArray<btSoftBody*> bodies;
    bodies.push_back(soft_.get());
    solver_.optimize(bodies);
    begin_step();
    solver_.tie(x_);
}

void BulletSolver::begin_step() {
    const Stopwatch watch(report_.contact_seconds);
    for (Contact* contact : contacts_) contact->begin_step(x_);
    solver_.forget_distances();
}

void BulletSolver::place(const Positions& x) {
    x_ = x;
    for (int v = 0; v < x.rows(); ++v) {
        soft_->m_nodes[v].m_x = to_bullet(x.row(v).transpose());
        soft_->m_nodes[v].m_q = soft_->m_nodes[v].m_x;
    }
}

/// As btSoftRigidDynamicsWorld::internalSingleStepSimulation.
void BulletSolver::substep() {
    for (int v = 0; v < x_.rows(); ++v) velocity_before_.row(v) = to_eigen(soft_->m_nodes[v].m_v).transpose();
    solver_.predictMotion(dt_);
    {
        const Stopwatch watch(report_.contact_seconds);
        for (const btCollisionObject& solid : solid_) {
            const btCollisionObjectWrapper wrapper(nullptr, nullptr, &solid, solid.getWorldTransform(), -1, -1);
            solver_.processCollision(soft_.get(), &wrapper);
        }
    }
    solver_.solveConstraints(dt_);
    stepped_ = true;
}

/// Dynamic relaxation by kinetic damping: what has passed its greatest speed has passed its rest.
void BulletSolver::drop_velocities_past_peak() {
    double energy = 0.0;
    for (int v = 0; v < x_.rows(); ++v) energy += 0.5 * model_.scene.mesh.mass[v] * soft_->m_nodes[v].m_v.length2();
    ++since_drop_;
    if (energy < kinetic_energy_ && since_drop_ >= shortest_swing) {
        for (int v = 0; v < x_.rows(); ++v) soft_->m_nodes[v].m_v.setZero();
        since_drop_ = 0;
        energy = 0.0;
    }
    kinetic_energy_ = energy;
}

void BulletSolver::run(int substeps, bool settling) {
    for (int k = 0; k < substeps; ++k) {
        substep();
        if (settling) drop_velocities_past_peak();
    }
    for (int v = 0; v < x_.rows(); ++v) x_.row(v) = to_eigen(soft_->m_nodes[v].m_x).transpose();
}

void BulletSolver::follow(const Positions& carried) {
    solver_.take_surface_velocities(carried, dt_ * substeps_);
    place(carried);
    begin_step();
    run(substeps_, false);
    solver_.rest_surfaces();
    solver_.tie(x_);
}

void BulletSolver::settle() {
    begin_step();
    run(options_.settle_substeps, true);
    solver_.tie(x_);
    ++report_.iterations;
}

double BulletSolver::net_force() const {
    double squared = 0.0;
    for (int v = 0; v < x_.rows(); ++v) {
        const btSoftBody::Node& node = soft_->m_nodes[v];
        if (!(node.m_im > 0.0)) continue;
        const Eigen::RowVector3d velocity = to_eigen(node.m_x - node.m_q).transpose() / dt_;
        squared += ((velocity - velocity_before_.row(v)) / (node.m_im * dt_)).squaredNorm();
    }
    return std::sqrt(squared);
}

double BulletSolver::residual_force() {
    if (stepped_) return net_force();
    const Snapshot now = snapshot();
    run(1, false);
    const double force = net_force();
    restore(now);
    return force;
}

Eigen::VectorXd BulletSolver::speeds() {
    const Snapshot now = snapshot();
    for (int v = 0; v < x_.rows(); ++v) soft_->m_nodes[v].m_v.setZero();
    run(substeps_, false);
    const Eigen::VectorXd speeds = (x_ - now.x).rowwise().norm() / (dt_ * substeps_);
    restore(now);
    return speeds;
}

double BulletSolver::largest_speed() {
    return speeds().maxCoeff();
}

BulletSolver::Snapshot BulletSolver::snapshot() const {
    Snapshot now{x_, velocity_before_, Positions(x_.rows(), 3), Positions(x_.rows(), 3), solver_.touches(), stepped_};
    for (int v = 0; v < x_.rows(); ++v) {
        now.before.row(v) = to_eigen(soft_->m_nodes[v].m_q).transpose();
        now.velocity.row(v) = to_eigen(soft_->m_nodes[v].m_v).transpose();
    }
    return now;
}

void BulletSolver::restore(const Snapshot& then) {
    place(then.x);
    velocity_before_ = then.velocity_before;
    for (int v = 0; v < x_.rows(); ++v) {
        soft_->m_nodes[v].m_q = to_bullet(then.before.row(v).transpose());
        soft_->m_nodes[v].m_v = to_bullet(then.velocity.row(v).transpose());
    }
    solver_.set_touches(then.touches);
    stepped_ = then.stepped;
}

double BulletSolver::energy() const {
    double energy = 0.0;
    for (const Spring& spring : springs_) {
        const double stretch = (x_.row(spring.first) - x_.row(spring.second)).norm() - spring.rest_length;
        energy += 0.5 * spring.stiffness * stretch * stretch;
    }
    for (int v = 0; v < x_.rows(); ++v) {
        const double mass = model_.scene.mesh.mass[v];
        energy +=
            0.5 * mass * to_eigen(soft_->m_nodes[v].m_v).squaredNorm() - mass * x_.row(v) * model_.scene.solver.gravity;
    }
    return energy;
}

}  // namespace

std::unique_ptr<Solver> make_bullet_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                           DrapeReport& report) {
    return std::make_unique<BulletSolver>(model, contacts, report);
}

}  // namespace toile::simulate

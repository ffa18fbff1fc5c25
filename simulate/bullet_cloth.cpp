#include "simulate/bullet_cloth.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// Mass of the bodies that stand for a solid's surface at one contact [kg]: so large that the cloth does not move them,
/// so small that the velocity it gives them can be read.
constexpr double surface_mass = 1e6;
/// Margin of the soft body's own trees [m]: wide, so that they need no work while nobody asks them.
constexpr double tree_margin = 1.0;
/// Passes over the soft contacts in each pass over the links: where many meet, one would leave some of them crossing.
constexpr int sheet_passes = 4;

btVector3 to_bullet(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}
Eigen::Vector3d to_eigen(const btVector3& v) {
    return {v.x(), v.y(), v.z()};
}

/// What each pass takes of an error, so that all take `share` of it together.
double share_of_pass(double share, int passes) {
    return 1.0 - std::pow(1.0 - share, 1.0 / passes);
}

/// Finds the soft body's contacts with the solids and with itself, and weighs them afterwards.
class ContactFillingSolver final : public btDefaultSoftBodySolver {
  public:
    ContactFillingSolver(std::vector<SolidTouches>& solids, std::optional<SheetTouches>& sheet)
        : solids_(solids), sheet_(sheet) {}

    double kept_by_sheet = 1.0;  // of velocities, in a substep

    /// The solid's index is the collision object's user index.
    void processCollision(btSoftBody* cloth, const btCollisionObjectWrapper* solid) override;
    /// Of a cloth with itself, after the solids.
    void processCollision(btSoftBody* cloth, btSoftBody* itself) override;
    void predictMotion(btScalar dt) override;
    void solveConstraints(btScalar dt) override;

  private:
    /// What a rigid contact of the soft body came from, in the order of `m_rcontacts`.
    struct Source {
        SolidTouches* touches;
        int vertex;
        SolidPush push;
    };
    void add_contact(btSoftBody& cloth, int vertex, const SolidPush& push);
    void weigh_solids(btSoftBody& cloth);
    void calm_sheet();
    btRigidBody& surface_body(size_t index);

    std::vector<SolidTouches>& solids_;
    std::optional<SheetTouches>& sheet_;
    std::vector<Source> source_;
    std::vector<std::unique_ptr<btRigidBody>> surface_;
    std::vector<btSoftBody::Face> face_;  // the three other vertices of each soft contact
    std::vector<bool> recovering_;        // of the soft contacts
    Positions before_, now_, supported_;
};

void ContactFillingSolver::predictMotion(btScalar dt) {
    source_.clear();
    recovering_.clear();
    btDefaultSoftBodySolver::predictMotion(dt);
}

btRigidBody& ContactFillingSolver::surface_body(size_t index) {
    while (surface_.size() <= index) {
        // Bullet numbers its rigid bodies with a global counter.
        static std::mutex numbering;
        const std::lock_guard lock(numbering);
        surface_.push_back(std::make_unique<btRigidBody>(surface_mass, nullptr, nullptr));
    }
    return *surface_[index];
}

void ContactFillingSolver::processCollision(btSoftBody* cloth, const btCollisionObjectWrapper* solid) {
    SolidTouches& touches = solids_[solid->getCollisionObject()->getUserIndex()];
    for (int v = 0; v < cloth->m_nodes.size(); ++v) {
        const btSoftBody::Node& node = cloth->m_nodes[v];
        if (!(node.m_im > 0.0)) continue;
        const auto push = touches.push(v, {to_eigen(node.m_q), to_eigen(node.m_x), 1.0 / node.m_im, cloth->m_sst.sdt});
        if (!push) continue;
        add_contact(*cloth, v, *push);
        source_.push_back({&touches, v, *push});
    }
}

/// Bullet moves a node in contact, unless it leaves, by −½ n (Δ·n + dp) − grip (Δ − n (Δ·n)), where Δ is its way in
/// this substep relative to the surface, dp = n·x + offset, and the ½ is in the impulse matrix. The offset is such that
/// the normal part is the push.
void ContactFillingSolver::add_contact(btSoftBody& cloth, int vertex, const SolidPush& push) {
    btSoftBody::Node& node = cloth.m_nodes[vertex];
    const double dt = cloth.m_sst.sdt;
    const Eigen::Vector3d& n = push.normal;
    btRigidBody& surface = surface_body(source_.size());
    surface.setLinearVelocity(to_bullet(push.along));
    btSoftBody::RContact c;
    c.t1.setZero();  // of multibodies: copied along
    c.t2.setZero();
    c.m_cti.m_colObj = &surface;
    c.m_cti.m_normal = to_bullet(n);
    c.m_cti.m_offset = n.dot(to_eigen(node.m_q)) - 2.0 * (n.dot(to_eigen(node.m_x)) + push.move);
    c.m_node = &node;
    const Eigen::Matrix3d impulse = (Eigen::Matrix3d::Identity() - 0.5 * n * n.transpose()) / (node.m_im * dt);
    c.m_c0.setValue(impulse(0, 0), impulse(0, 1), impulse(0, 2), impulse(1, 0), impulse(1, 1), impulse(1, 2),
                    impulse(2, 0), impulse(2, 1), impulse(2, 2));
    c.m_c1.setZero();
    c.m_c2 = node.m_im * dt;
    c.m_c3 = 1.0 - share_of_pass(push.grip, cloth.m_cfg.piterations);  // the slip that is left
    c.m_c4 = 1.0;
    cloth.m_rcontacts.push_back(c);
}

/// Bullet's soft contact brings a node that nears its face to a margin, and takes a share of their slip.
void ContactFillingSolver::processCollision(btSoftBody* cloth, btSoftBody* itself) {
    if (!sheet_ || cloth != itself) return;
    const int count = cloth->m_nodes.size();
    before_.resize(count, 3);
    now_.resize(count, 3);
    for (int v = 0; v < count; ++v) {
        before_.row(v) = to_eigen(cloth->m_nodes[v].m_q).transpose();
        now_.row(v) = to_eigen(cloth->m_nodes[v].m_x).transpose();
    }
    supported_.setZero(count, 3);
    for (const Source& source : source_) supported_.row(source.vertex) = source.push.normal.transpose();
    const std::vector<SheetPush>& pushes = sheet_->pushes(before_, now_, supported_, cloth->m_sst.sdt);
    face_.resize(pushes.size());  // before any is pointed to
    for (size_t k = 0; k < pushes.size(); ++k) {
        const SheetPush& push = pushes[k];
        btSoftBody::SContact c;
        c.m_node = &cloth->m_nodes[push.vertex];
        c.m_face = &face_[k];
        for (int i = 0; i < 3; ++i) c.m_face->m_n[i] = &cloth->m_nodes[push.other[i]];
        c.m_weights = btVector3(push.weight[0], push.weight[1], push.weight[2]);
        c.m_normal = to_bullet(push.normal);
        c.m_margin = push.gap;
        c.m_friction = share_of_pass(push.grip, sheet_passes * cloth->m_cfg.piterations);
        c.m_cfm[0] = push.vertex_share;
        c.m_cfm[1] = push.other_share;
        cloth->m_scontacts.push_back(c);
        recovering_.push_back(push.recovering);
    }
}

void ContactFillingSolver::solveConstraints(btScalar dt) {
    btDefaultSoftBodySolver::solveConstraints(dt);
    weigh_solids(*m_softBodySet[0]);
    calm_sheet();
}

void ContactFillingSolver::weigh_solids(btSoftBody& cloth) {
    for (size_t i = 0; i < source_.size(); ++i) {
        const auto& [touches, vertex, push] = source_[i];
        const Eigen::Vector3d impulse = surface_mass * (to_eigen(surface_[i]->getLinearVelocity()) - push.along);
        const double normal = -push.normal.dot(impulse);
        touches->weigh(vertex, std::max(0.0, normal), (impulse + normal * push.normal).norm());
        btSoftBody::Node& node = cloth.m_nodes[vertex];
        const double leaving = push.normal.dot(to_eigen(node.m_v));
        if (push.recovering && leaving > 0.0) node.m_v -= to_bullet(leaving * push.normal);
    }
}

/// Layers that were too near are not to fly apart, and where they touch they are slowed.
void ContactFillingSolver::calm_sheet() {
    const auto& contacts = m_softBodySet[0]->m_scontacts;
    for (size_t k = 0; k < recovering_.size(); ++k) {
        const btSoftBody::SContact& c = contacts[static_cast<int>(k)];
        c.m_node->m_v *= kept_by_sheet;
        for (int i = 0; i < 3; ++i) c.m_face->m_n[i]->m_v *= kept_by_sheet;
        if (!recovering_[k]) continue;
        btVector3 velocity = c.m_node->m_v;
        for (int i = 0; i < 3; ++i) velocity -= c.m_weights[i] * c.m_face->m_n[i]->m_v;
        const double leaving = c.m_normal.dot(velocity);
        if (!(leaving > 0.0)) continue;
        c.m_node->m_v -= c.m_normal * (leaving * c.m_cfm[0]);
        for (int i = 0; i < 3; ++i) c.m_face->m_n[i]->m_v += c.m_normal * (leaving * c.m_cfm[1] * c.m_weights[i]);
    }
}

}  // namespace

struct BulletCloth::Impl {
    Impl(std::vector<SolidTouches>& solids, std::optional<SheetTouches>& sheet, DrapeReport& to)
        : solver(solids, sheet), solid(solids.size()), feels_itself(sheet.has_value()), report(to) {
        for (size_t k = 0; k < solid.size(); ++k) solid[k].setUserIndex(static_cast<int>(k));
    }
    void make_soft_body(const BulletClothSetup& setup, const Positions& x);
    void add_links(const BulletClothSetup& setup);

    btSoftBodyWorldInfo world;
    ContactFillingSolver solver;
    std::vector<btCollisionObject> solid;
    std::unique_ptr<btSoftBody> soft;
    bool feels_itself;
    double time_step = 0.0;
    DrapeReport& report;
};

void BulletCloth::Impl::make_soft_body(const BulletClothSetup& setup, const Positions& x) {
    const int count = static_cast<int>(x.rows());
    std::vector<btVector3> position(static_cast<size_t>(count));
    std::vector<btScalar> mass(setup.mass.data(), setup.mass.data() + count);
    for (int v = 0; v < count; ++v) position[v] = to_bullet(x.row(v).transpose());
    for (int v : setup.pinned) mass[v] = 0.0;
    soft = std::make_unique<btSoftBody>(&world, count, position.data(), mass.data());
    soft->getCollisionShape()->setMargin(tree_margin);
    soft->m_cfg.piterations = setup.passes;
    auto& sequence = soft->m_cfg.m_psequence;
    sequence.clear();
    sequence.push_back(btSoftBody::ePSolver::Linear);
    sequence.push_back(btSoftBody::ePSolver::RContacts);
    for (int k = 0; feels_itself && k < sheet_passes; ++k) sequence.push_back(btSoftBody::ePSolver::SContacts);
    btAlignedObjectArray<btSoftBody*> bodies;
    bodies.push_back(soft.get());
    solver.optimize(bodies);
}

void BulletCloth::Impl::add_links(const BulletClothSetup& setup) {
    const double h2 = setup.time_step * setup.time_step;
    for (const Spring& spring : setup.springs) {
        soft->appendLink(spring.first, spring.second);
        btSoftBody::Link& link = soft->m_links[soft->m_links.size() - 1];
        const double w = soft->m_nodes[spring.first].m_im + soft->m_nodes[spring.second].m_im;
        const double stiff = spring.stiffness * h2 * w, share = share_of_pass(stiff / (1.0 + stiff), setup.passes);
        link.m_rl = spring.rest_length;
        link.m_c1 = spring.rest_length * spring.rest_length;
        link.m_c0 = w > 0.0 ? w / share : 0.0;  // as Bullet's updateLinkConstants, with a kLST for each link
    }
    soft->m_bUpdateRtCst = false;  // or Bullet would take rest lengths from the positions
}

BulletCloth::BulletCloth(const BulletClothSetup& setup, const Positions& x, std::vector<SolidTouches>& solids,
                         std::optional<SheetTouches>& sheet, DrapeReport& report)
    : impl_(std::make_unique<Impl>(solids, sheet, report)) {
    impl_->world.m_gravity = to_bullet(setup.gravity);
    impl_->time_step = setup.time_step;
    impl_->make_soft_body(setup, x);
    impl_->add_links(setup);
}

BulletCloth::~BulletCloth() = default;

void BulletCloth::set_damping(double damping, double kept_by_sheet) {
    const double taken = damping * impl_->time_step;
    impl_->soft->m_cfg.kDP = taken / (1.0 + taken);
    impl_->solver.kept_by_sheet = kept_by_sheet;
}

void BulletCloth::add_force(const Positions& force) {
    for (int v = 0; v < force.rows(); ++v) impl_->soft->addForce(to_bullet(force.row(v).transpose()), v);
}

/// As btSoftRigidDynamicsWorld::internalSingleStepSimulation.
void BulletCloth::substep() {
    impl_->solver.predictMotion(impl_->time_step);
    {
        const Stopwatch watch(impl_->report.contact_seconds);
        for (const btCollisionObject& solid : impl_->solid) {
            const btCollisionObjectWrapper wrapper(nullptr, nullptr, &solid, solid.getWorldTransform(), -1, -1);
            impl_->solver.processCollision(impl_->soft.get(), &wrapper);
        }
    }
    if (impl_->feels_itself) {
        const Stopwatch watch(impl_->report.self_contact_seconds);
        impl_->solver.processCollision(impl_->soft.get(), impl_->soft.get());
    }
    impl_->solver.solveConstraints(impl_->time_step);
}

BulletCloth::State BulletCloth::state() const {
    const auto& nodes = impl_->soft->m_nodes;
    State state{Positions(nodes.size(), 3), Positions(nodes.size(), 3), Positions(nodes.size(), 3)};
    for (int v = 0; v < nodes.size(); ++v) {
        state.position.row(v) = to_eigen(nodes[v].m_x).transpose();
        state.before.row(v) = to_eigen(nodes[v].m_q).transpose();
        state.velocity.row(v) = to_eigen(nodes[v].m_v).transpose();
    }
    return state;
}

void BulletCloth::set_state(const State& state) {
    auto& nodes = impl_->soft->m_nodes;
    for (int v = 0; v < nodes.size(); ++v) {
        nodes[v].m_x = to_bullet(state.position.row(v).transpose());
        nodes[v].m_q = to_bullet(state.before.row(v).transpose());
        nodes[v].m_v = to_bullet(state.velocity.row(v).transpose());
    }
}

}  // namespace toile::simulate

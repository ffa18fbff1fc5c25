#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "simulate/bullet_solver.h"
#include "simulate/certificate.h"
#include "simulate/contact.h"
#include "simulate/drape_model.h"
#include "simulate/self_intersection.h"
#include "tests/simulate/cloth_square.h"
#include "tests/simulate/two_layers.h"

namespace toile::simulate {
namespace {

constexpr double gravity = 9.81;

DrapeScene square_scene(int n, double side, double height) {
    DrapeScene scene;
    scene.mesh = test::cloth_square(n, side, height);
    scene.bending.emplace();
    scene.solver.solver = "bullet";
    return scene;
}

/// The two upper corners of the pattern.
void pin_top(DrapeScene& scene, int n) {
    scene.pinned = {n * (n + 1), n * (n + 1) + n};
}

/// A model, the solids it touches and the solver that drapes it.
struct Drape {
    DrapeModel model;
    std::vector<std::unique_ptr<Contact>> contacts;
    DrapeReport report;
    std::unique_ptr<Solver> solver;

    explicit Drape(const DrapeScene& scene, const Obstacle* obstacle = nullptr) : model(scene) {
        std::vector<Contact*> raw;
        if (obstacle) {
            contacts.push_back(std::make_unique<Contact>(*scene.contact, model.pressure, model.points, *obstacle));
            raw.push_back(contacts.back().get());
        }
        solver = make_bullet_solver(model, raw, report);
        solver->start(model.scene.mesh.rest_position);
    }
    const Positions& settle(int steps) {
        for (int k = 0; k < steps; ++k) solver->settle();
        return solver->position();
    }
    StretchRange stretch() const { return stretch_range(model.topology, model.rest_length, solver->position()); }
};

/// A half space below a plane through `offset`, tilted by `angle` about z, that can be moved.
class Plane final : public Obstacle {
  public:
    explicit Plane(double angle = 0.0) : normal(std::sin(angle), std::cos(angle), 0.0) {}
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        return {normal.dot(point - offset), normal};
    }
    Eigen::Vector3d to_world(const Eigen::Vector3d& local, int /*piece*/) const override { return local + offset; }
    Eigen::Vector3d to_local(const Eigen::Vector3d& world, int /*piece*/) const override { return world - offset; }

    Eigen::Vector3d normal, offset = Eigen::Vector3d::Zero();
};

double lowest(const Obstacle& obstacle, const Positions& x) {
    double least = std::numeric_limits<double>::infinity();
    for (int v = 0; v < x.rows(); ++v) least = std::min(least, obstacle.distance(x.row(v).transpose(), 0));
    return least;
}

TEST(BulletSolver, FallsFreely) {
    DrapeScene scene = square_scene(5, 0.2, 1.0);
    scene.solver.damping = 0.0;
    Drape run(scene);
    const Positions start = run.solver->position();
    const int steps = 6;
    for (int k = 0; k < steps; ++k) run.solver->follow(run.solver->position());
    const double h = scene.solver.time_step;
    const int n = steps * static_cast<int>(std::ceil(h / scene.solver.bullet.substep));
    const double dt = steps * h / n, fall = gravity * dt * dt * n * (n + 1) / 2.0;  // symplectic Euler
    const Positions move = run.solver->position() - start;
    EXPECT_NEAR(move.col(1).minCoeff(), -fall, 1e-9);
    EXPECT_NEAR(move.col(1).maxCoeff(), -fall, 1e-9);
    EXPECT_LT(move.col(0).cwiseAbs().maxCoeff() + move.col(2).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(run.solver->largest_speed(), gravity * h * (1.0 + steps / double(n)) / 2.0, 1e-9) << "from rest";
    EXPECT_EQ(run.solver->position() - start, move) << "asking moves nothing";
    EXPECT_NEAR(run.solver->residual_force(), gravity * scene.mesh.mass.norm(), 1e-9);
}

TEST(BulletSolver, ResidualIsTheWeightBeforeAnyStep) {
    DrapeScene scene = square_scene(5, 0.2, 1.0);
    Drape run(scene);
    EXPECT_NEAR(run.solver->residual_force(), gravity * scene.mesh.mass.norm(), 1e-9);
    EXPECT_EQ(run.solver->position(), scene.mesh.rest_position) << "asking moves nothing";
}

TEST(BulletSolver, LinksKeepMomentum) {
    DrapeScene scene = square_scene(6, 0.3, 0.0);
    scene.solver.gravity.setZero();
    scene.solver.damping = 0.0;
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 0.004);
    Drape run(scene);
    const Positions start = run.solver->position();
    for (int k = 0; k < 5; ++k) run.solver->follow(run.solver->position());
    const Positions move = run.solver->position() - start;
    const double moved = scene.mesh.mass.dot(move.rowwise().norm());
    EXPECT_GT(moved, 1e-5) << "the links do pull";
    EXPECT_LT((scene.mesh.mass.transpose() * move).norm(), 1e-9 * moved);
}

TEST(BulletSolver, HangsFromItsPins) {
    const int n = 12;
    DrapeScene scene = square_scene(n, 0.4, 0.0);
    pin_top(scene, n);
    Drape run(scene);
    const double start = run.solver->energy();
    const Positions& x = run.settle(200);
    ASSERT_TRUE(x.allFinite());
    for (int v : scene.pinned) EXPECT_EQ(x.row(v), scene.mesh.rest_position.row(v));
    EXPECT_LT(x.col(1).minCoeff(), -0.35);
    EXPECT_GT(x.col(1).minCoeff(), -0.65);
    EXPECT_LT(run.stretch().largest, 1.15);
    EXPECT_LT(run.solver->residual_force(), 1e-3 * run.model.weight);
    EXPECT_LT(run.solver->largest_speed(), 0.01);
    EXPECT_EQ(run.report.iterations, 200);
    EXPECT_EQ(run.solver->speeds().maxCoeff(), run.solver->largest_speed());
    EXPECT_LT(run.solver->energy(), start) << "it fell, and damping took what that gave";
}

TEST(BulletSolver, StretchesLessWithMorePassesAndShorterSubsteps) {
    const int n = 10;
    auto largest_stretch = [&](double substep, int passes) {
        DrapeScene scene = square_scene(n, 0.4, 0.0);
        pin_top(scene, n);
        scene.solver.bullet = {substep, passes, static_cast<int>(0.01 / substep)};
        Drape run(scene);
        run.settle(120);
        return run.stretch().largest;
    };
    const double coarse = largest_stretch(0.002, 1), passes = largest_stretch(0.002, 8);
    const double substeps = largest_stretch(0.00025, 1);
    EXPECT_LT(passes, 1.0 + 0.7 * (coarse - 1.0));
    EXPECT_LT(substeps, 1.0 + 0.5 * (coarse - 1.0));
}

TEST(BulletSolver, SurvivesExtremeMaterials) {
    const int n = 8;
    for (const double factor : {1e-3, 1e5}) {
        DrapeScene scene = square_scene(n, 0.3, 0.0);
        pin_top(scene, n);
        scene.membrane.warp_stiffness *= factor;
        scene.membrane.weft_stiffness *= factor;
        scene.membrane.shear_stiffness *= factor;
        scene.bending->stiffness *= factor;
        Drape run(scene);
        const Positions& x = run.settle(100);
        ASSERT_TRUE(x.allFinite()) << factor;
        EXPECT_LT(x.cwiseAbs().maxCoeff(), factor < 1.0 ? 10.0 : 1.0) << factor;
    }
}

TEST(BulletSolver, LiesOnATable) {
    DrapeScene scene = square_scene(8, 0.3, 0.05);
    scene.contact.emplace();
    scene.table.emplace();
    const Table table(*scene.table);
    Drape run(scene, &table);
    for (int k = 0; k < 60; ++k) {
        run.settle(1);
        ASSERT_GT(lowest(table, run.solver->position()), scene.contact->thickness - 1e-6) << k;
    }
    const Positions& x = run.settle(60);
    EXPECT_LT(x.col(1).maxCoeff(), 1.01 * scene.contact->thickness + 1e-6);
    EXPECT_LT(run.solver->residual_force(), 1e-3 * run.model.weight);
}

TEST(BulletSolver, DrapesOverASphere) {
    DrapeScene scene = square_scene(16, 0.6, 0.16);
    scene.contact.emplace();
    scene.sphere = SphereOptions{Eigen::Vector3d::Zero(), 0.15};
    const Sphere sphere(*scene.sphere);
    Drape run(scene, &sphere);
    for (int k = 0; k < 100; ++k) {
        run.settle(1);
        ASSERT_GT(lowest(sphere, run.solver->position()), scene.contact->thickness - 3e-4) << k;
    }
    const Positions& x = run.solver->position();
    ASSERT_TRUE(x.allFinite());
    EXPECT_GT(x.col(1).maxCoeff(), 0.15) << "it rests on top";
    EXPECT_LT(x.col(1).minCoeff(), -0.1) << "it hangs down";
}

TEST(BulletSolver, RisesFromBelowASurfaceWithoutBeingThrown) {
    DrapeScene scene = square_scene(6, 0.3, -0.015);
    scene.contact.emplace();
    scene.table.emplace();
    const Table table(*scene.table);
    Drape run(scene, &table);
    double highest = -1.0;
    for (int k = 0; k < 60; ++k) highest = std::max(highest, run.settle(1).col(1).maxCoeff());
    EXPECT_LT(highest, scene.contact->thickness + 5e-4);
    EXPECT_GT(lowest(table, run.solver->position()), scene.contact->thickness - 1e-6);
}

/// A slot between two half spaces at y = ±0.0012 m: narrower than twice the thickness.
class Slot final : public Obstacle {
  public:
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        return {0.0012 - std::abs(point.y()), Eigen::Vector3d(0.0, point.y() > 0.0 ? -1.0 : 1.0, 0.0)};
    }
};

TEST(BulletSolver, RestsBetweenTwoSurfacesThatSqueezeIt) {
    DrapeScene scene = square_scene(6, 0.2, 0.0);
    scene.contact.emplace();
    scene.table.emplace();
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 5e-4);
    const Slot slot;
    Drape run(scene, &slot);
    run.settle(40);
    EXPECT_GT(lowest(slot, run.solver->position()), 5e-4);
    EXPECT_LT(run.solver->largest_speed(), 1e-3);
    EXPECT_LT(run.solver->residual_force(), 1e-2 * run.model.weight);
}

/// Mean way along x of a sheet that lies on a plane, while the plane moves below it at 0.15 m/s for 0.66 s.
double dragged(double friction) {
    DrapeScene scene = square_scene(6, 0.2, 0.002);
    scene.contact.emplace();
    scene.contact->friction = friction;
    scene.table.emplace();
    Plane plane;
    Drape run(scene, &plane);
    run.settle(5);
    const Positions start = run.solver->position();
    for (int k = 0; k < 20; ++k) {
        plane.offset.x() += 0.15 * scene.solver.time_step;
        run.solver->follow(run.solver->position());  // nothing but friction takes it along
    }
    return (run.solver->position() - start).col(0).mean();
}

TEST(BulletSolver, AMovingTableTakesClothAlongByFrictionAlone) {
    const double way = 0.15 * 20 * SolverOptions{}.time_step;
    EXPECT_NEAR(dragged(0.5), way, 0.1 * way);
    EXPECT_NEAR(dragged(0.0), 0.0, 1e-9);
}

TEST(BulletSolver, SlidesDownAnInclineByCoulombsLaw) {
    const double angle = 0.4;  // tan 0.4 = 0.423
    for (const double friction : {0.0, 0.2, 0.6}) {
        Plane plane(angle);
        DrapeScene scene = square_scene(6, 0.2, 0.0);
        scene.contact.emplace();
        scene.contact->friction = friction;
        scene.table.emplace();
        scene.solver.damping = 0.0;
        const Eigen::Vector3d down(std::cos(angle), -std::sin(angle), 0.0);
        for (int v = 0; v < scene.mesh.vertex_count(); ++v) {
            const Eigen::Vector3d p = scene.mesh.rest_position.row(v).transpose();
            scene.mesh.rest_position.row(v) =
                (p.x() * down + Eigen::Vector3d(0, 0, p.z()) + 0.002 * plane.normal).transpose();
        }
        Drape run(scene, &plane);
        const Positions start = run.solver->position();
        const int steps = 10;
        for (int k = 0; k < steps; ++k) run.solver->follow(run.solver->position());
        const double time = steps * scene.solver.time_step;
        const double pull = std::max(0.0, std::sin(angle) - friction * std::cos(angle));
        const double way = ((run.solver->position() - start) * down).mean();
        EXPECT_NEAR(way, 0.5 * gravity * pull * time * time, 0.02 * 0.5 * gravity * time * time) << friction;
    }
}

TEST(BulletSolver, IsCarriedWithTheSolids) {
    DrapeScene scene = square_scene(6, 0.2, 0.002);
    scene.contact.emplace();
    scene.table.emplace();
    Plane plane;
    Drape run(scene, &plane);
    run.settle(5);
    const Positions start = run.solver->position();
    plane.offset = {0.03, 0.02, 0.0};
    Positions carried = start;
    carried.rowwise() += plane.offset.transpose();
    run.solver->follow(carried);
    EXPECT_LT((run.solver->position() - carried).cwiseAbs().maxCoeff(), 1e-5);
}

/// A sheet that falls 3 mm onto another one, which hangs by its rim.
Positions fallen_sheet(bool feels_itself, int steps, int& crossings) {
    const int n = 6;
    DrapeScene scene;
    scene.mesh = test::two_layers(0.003, n, 0.12);
    scene.solver.solver = "bullet";
    if (feels_itself) scene.self_contact.emplace();
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            if (i == 0 || j == 0 || i == n || j == n) scene.pinned.push_back(j * (n + 1) + i);
    Drape run(scene);
    const Positions& x = run.settle(steps);
    crossings = count_self_intersections(scene.mesh.triangle, x);
    return x;
}

TEST(BulletSolver, LayersFeelEachOther) {
    const int steps = 6;  // of 10 ms: 18 mm of free fall
    int crossings = -1, unfelt = -1;
    const Positions with = fallen_sheet(true, steps, crossings), without = fallen_sheet(false, steps, unfelt);
    const Eigen::Index half = with.rows() / 2, middle = half + half / 2;
    EXPECT_LT(without(middle, 1), -0.004) << "nothing holds it";
    EXPECT_GT(with(middle, 1), with(half / 2, 1)) << "the lower layer does, which sags";
    EXPECT_EQ(crossings, 0);
}

TEST(BulletSolver, WindMovesWhatHangsInIt) {
    DrapeScene scene = square_scene(6, 0.2, 1.0);
    scene.solver.gravity.setZero();
    scene.solver.damping = 0.0;
    scene.wind.emplace();
    scene.wind->velocity = {0.0, 4.0, 0.0};
    Drape run(scene);
    run.solver->follow(run.solver->position());
    // A plate across a wind u gains the speed v as dv/dt = ρ C_D (u − v)² / (2 σ) with its density σ.
    const double rate = 1.2 * 1.2 / (2.0 * 0.2), h = scene.solver.time_step;
    const double speed = 4.0 - 1.0 / (1.0 / 4.0 + rate * h);
    const Positions way = run.solver->position() - scene.mesh.rest_position;
    const double expected = 4.0 * h - std::log(1.0 + 4.0 * rate * h) / rate;
    EXPECT_GT(speed, 0.0);
    EXPECT_NEAR(way.col(1).mean(), expected, 0.03 * expected);
}

TEST(BulletSolver, KeepsTheFoldsItStartsWith) {
    const auto opened = [](BendingRest rest) {
        DrapeScene scene = square_scene(2, 0.2, 0.0);
        scene.solver.gravity.setZero();
        scene.bending->rest = rest;
        scene.bending->stiffness = 1e-3;
        const Eigen::VectorXd along = scene.mesh.rest_position.col(0);
        for (int v = 0; v < along.size(); ++v) {  // bent along its middle
            scene.mesh.rest_position(v, 0) = std::cos(0.5) * along[v];
            scene.mesh.rest_position(v, 1) = std::sin(0.5) * std::abs(along[v]);
        }
        Drape run(scene);
        run.settle(50);
        return (run.solver->position() - scene.mesh.rest_position).rowwise().norm().maxCoeff();
    };
    EXPECT_LT(opened(BendingRest::start), 1e-9);
    EXPECT_GT(opened(BendingRest::flat), 1e-3);
}

TEST(BulletSolver, SameBytesTwiceAndFromTwoThreads) {
    DrapeScene scene = square_scene(10, 0.5, 0.16);
    scene.contact.emplace();
    scene.sphere = SphereOptions{Eigen::Vector3d::Zero(), 0.15};
    const Sphere sphere(*scene.sphere);
    auto drape = [&] {
        Drape run(scene, &sphere);
        run.solver->residual_force();
        return Positions(run.settle(40));
    };
    const Positions first = drape();
    EXPECT_EQ(drape(), first);
    std::vector<Positions> found(2);
    std::vector<std::thread> threads;
    for (Positions& x : found) threads.emplace_back([&] { x = drape(); });
    for (std::thread& thread : threads) thread.join();
    for (const Positions& x : found) EXPECT_EQ(x, first);
}

}  // namespace
}  // namespace toile::simulate

#include "simulate/drape.h"

#include <string>

#include "cloth/error.h"
#include "simulate/body_intersection.h"
#include "simulate/drape_model.h"
#include "simulate/drape_run.h"
#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// What is to be draped: from `start` to `pose`, or where the cloth is if there is none.
struct Task {
    const Positions& start;
    const skin::Pose* pose;
    const EnergyWatch& watch;
};

/// One drape from start to certificate.
DrapeResult drape_once(const DrapeModel& model, const Task& task, int rung) {
    DrapeRun run(model);
    const int joints = model.scene.body ? model.scene.body->joint_count() : 0;
    skin::Pose reached = skin::Pose::Zero(joints, 3);
    const bool afresh = rung >= 3 && task.pose;
    run.start(afresh ? model.scene.mesh.rest_position : task.start, reached);
    if (afresh) run.settle(task.watch);
    if (task.pose) {
        const std::vector<skin::Pose> path = rung_path(*model.scene.body, *task.pose, rung);
        for (const skin::Pose& next : path) {
            run.follow(reached, next);
            reached = next;
            if (&next != &path.back()) run.settle(task.watch);
        }
    }
    run.settle(task.watch);
    return run.finish();
}

/// One rung, in a model of its own where its settings differ from the scene's.
DrapeResult drape_on_rung(const DrapeModel& model, const Task& task, int rung) {
    if (rung == 0) return drape_once(model, task, rung);
    const DrapeModel changed(rung_scene(model.scene, rung));
    return drape_once(changed, task, rung);
}

/// Whether it is the body that cannot be draped.
bool body_is_at_fault(const DrapeModel& model, const Task& task, const Positions& cloth) {
    if (!model.scene.body || !task.pose) return false;
    const Positions posed = skin::skin_positions(*model.scene.body, *task.pose, model.scene.skinning);
    return body_self_intersection(*model.scene.body, posed, cloth).depth > intersecting_depth;
}

/// Up the ladder to the first accepted drape.
DrapeResult climb(const DrapeModel& model, const Task& task) {
    DrapeResult best;
    std::vector<TryRecord> tries;
    for (const int rung : rungs(model.scene.ladder, task.pose != nullptr)) {
        DrapeResult next = drape_on_rung(model, task, rung);
        tries.push_back({rung, next.status, next.certificate});
        const bool done = next.status == DrapeStatus::accepted;
        if (done || tries.size() == 1 || better(next, best)) {
            best = std::move(next);
            best.certificate.rung = rung;
        }
        if (done) break;
        if (tries.size() == 1 && body_is_at_fault(model, task, best.position)) {
            best.status = DrapeStatus::body_intersects_itself;
            break;
        }
    }
    best.certificate.tries = static_cast<int>(tries.size());
    best.certificate.iterations = best.certificate.path_steps = 0;
    for (const TryRecord& one : tries) {
        best.certificate.iterations += one.certificate.iterations;
        best.certificate.path_steps += one.certificate.path_steps;
        best.certificate.rungs[static_cast<size_t>(one.rung)] = {static_cast<int>(one.status),
                                                                 one.certificate.residual_force};
    }
    best.tries = std::move(tries);
    return best;
}

DrapeResult drape_from(const DrapeModel& model, const Task& task) {
    DrapeResult result;
    double seconds = 0.0;
    {
        const Stopwatch stopwatch(seconds);
        result = climb(model, task);
    }
    result.certificate.seconds = seconds;
    return result;
}

}  // namespace

Draper::Draper(const DrapeScene& scene) : model_(std::make_unique<const DrapeModel>(scene)) {}
Draper::~Draper() = default;

DrapeResult Draper::drape_neutral(const EnergyWatch& watch) const {
    return drape_from(*model_, {model_->scene.mesh.rest_position, nullptr, watch});
}

DrapeResult Draper::drape(const Positions& neutral_drape, const skin::Pose& pose, const EnergyWatch& watch) const {
    if (!model_->scene.body) throw Error("a scene without a body has no poses to drape");
    if (pose.rows() != model_->scene.body->joint_count() || !pose.allFinite())
        throw Error("the pose has " + std::to_string(pose.rows()) + " joints, the body " +
                    std::to_string(model_->scene.body->joint_count()) + ", or it is not finite");
    if (neutral_drape.rows() != model_->scene.mesh.vertex_count())
        throw Error("the neutral drape has another number of vertices than the garment");
    return drape_from(*model_, {neutral_drape, &pose, watch});
}

}  // namespace toile::simulate

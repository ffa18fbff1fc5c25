#include "simulate/drape.h"

#include <string>

#include "cloth/error.h"
#include "simulate/drape_model.h"
#include "simulate/drape_run.h"
#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// One drape from start to certificate; along the way to `pose`, where there is one.
DrapeResult drape_from(const DrapeModel& model, const Positions& start, const skin::Pose* pose,
                       const EnergyWatch& watch) {
    DrapeResult result;
    double seconds = 0.0;
    {
        const Stopwatch stopwatch(seconds);
        DrapeRun run(model);
        const int joints = model.scene.body ? model.scene.body->joint_count() : 0;
        const skin::Pose neutral = skin::Pose::Zero(joints, 3);
        run.start(start, neutral);
        if (pose) run.follow(neutral, *pose);
        run.settle(watch);
        result = run.finish();
    }
    result.certificate.seconds = seconds;
    return result;
}

}  // namespace

Draper::Draper(const DrapeScene& scene) : model_(std::make_unique<const DrapeModel>(scene)) {}
Draper::~Draper() = default;

DrapeResult Draper::drape_neutral(const EnergyWatch& watch) const {
    return drape_from(*model_, model_->scene.mesh.rest_position, nullptr, watch);
}

DrapeResult Draper::drape(const Positions& neutral_drape, const skin::Pose& pose, const EnergyWatch& watch) const {
    if (!model_->scene.body) throw Error("a scene without a body has no poses to drape");
    if (pose.rows() != model_->scene.body->joint_count() || !pose.allFinite())
        throw Error("the pose has " + std::to_string(pose.rows()) + " joints, the body " +
                    std::to_string(model_->scene.body->joint_count()) + ", or it is not finite");
    if (neutral_drape.rows() != model_->scene.mesh.vertex_count())
        throw Error("the neutral drape has another number of vertices than the garment");
    return drape_from(*model_, neutral_drape, &pose, watch);
}

}  // namespace toile::simulate

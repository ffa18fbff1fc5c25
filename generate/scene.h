#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "generate/scene_config.h"
#include "pattern/embedding.h"
#include "pattern/garment.h"
#include "simulate/drape.h"
#include "skin/body.h"
#include "skin/pose_source.h"

namespace toile::generate {

/// What a configuration describes, built: bodies and garments read or made, nothing draped yet.
struct Scene {
    SceneConfig config;
    std::optional<skin::Body> body;
    std::unique_ptr<skin::PoseSource> poses;  ///< null without [poses]
    std::vector<std::int64_t> pose_number;    ///< `[N]` the poses wanted
    pattern::Garment garment;                 ///< with masses
    std::vector<int> pinned;
    std::vector<std::string> remarks;  ///< what was found out or mended in body and garment, one sentence each
};

/// Only the body and its poses: all that `toile skin` needs.
Scene build_posed_body(const SceneConfig& config);
/// The whole scene.
Scene build_scene(const SceneConfig& config);

/// The solver for this scene.
std::unique_ptr<simulate::Draper> make_draper(const Scene& scene);

/// A scene with its garment draped in the neutral pose: what all samples share. Immutable.
struct DressedScene {
    Scene scene;
    std::unique_ptr<simulate::Draper> draper;
    ClothMesh mesh;  ///< the garment with the neutral drape, which all others start from, as its rest position
    std::optional<pattern::Embedding> embedding;  ///< where there is a body
};

/// Drapes the garment in the neutral pose and shrink-wraps it to the body. A neutral drape that is not accepted is a
/// remark, as samples are judged on their own; one that is not finite is an Error.
DressedScene dress(Scene scene);
/// The same where the neutral drape `[V x 3]` [m] is known.
DressedScene dress_again(Scene scene, const Positions& neutral);

}  // namespace toile::generate

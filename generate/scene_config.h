#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/config_file.h"
#include "generate/evaluation_config.h"
#include "pattern/garment_file.h"
#include "pattern/patch.h"
#include "pattern/pattern_image.h"
#include "pattern/tshirt.h"
#include "simulate/drape.h"
#include "simulate/material.h"
#include "simulate/options.h"
#include "skin/anatomy.h"
#include "skin/builtin_body.h"
#include "skin/motion_poses.h"
#include "skin/pose_sampler.h"
#include "skin/pose_source.h"
#include "skin/rigged_body.h"
#include "skin/skinning.h"

namespace toile::generate {

/// [body]: made by code, or read from a file.
struct BodyConfig {
    bool builtin = true;
    skin::BuiltinBodyOptions builtin_options;
    files::ConfigPath file;
    skin::RiggedBodyOptions rigged_options;
    skin::SkinningMethod skinning = skin::SkinningMethod::linear;
    std::string licence = "not stated";  ///< for the data card
};

enum class PoseSource { sampler, bvh, table };

/// [poses]: which postures the body takes.
struct PosesConfig {
    PoseSource source = PoseSource::sampler;
    int count = 12;  ///< poses of the sampler
    skin::SamplerOptions sampler;
    files::ConfigPath file;
    skin::MotionOptions motion;
    double arm_clearance = 0.0;     ///< that arms are to keep from the trunk [m]; 0: poses as they are
    skin::PoseSelection selection;  ///< which of the source's poses become samples
};

enum class GarmentSource { tshirt, patch, file };

/// [garment]: where the cloth comes from.
struct GarmentConfig {
    GarmentSource source = GarmentSource::tshirt;
    pattern::TshirtOptions tshirt;
    pattern::PatchOptions patch;
    files::ConfigPath file;
    pattern::GarmentFileOptions file_options;
    std::string licence = "not stated";  ///< for the data card
};

/// [output]
struct OutputConfig {
    int compression = 3;                ///< gzip level, 0 to 9; docs/corpus.md has what each costs
    int part = 256;                     ///< samples of a shard that are sealed together
    std::vector<int> look = {0, 1, 2};  ///< pose numbers to write pictures of
};

/// A whole scene. The defaults of every key are those of the rooms' options structs; a feature whose table is absent is
/// an empty optional here and is not built.
struct SceneConfig {
    std::string name = "scene";
    std::uint64_t seed = 0;
    std::optional<BodyConfig> body;
    std::optional<PosesConfig> poses;
    GarmentConfig garment;
    simulate::MembraneOptions membrane;
    std::optional<simulate::BendingOptions> bending;
    std::optional<simulate::StrainLimitOptions> strain_limit;
    std::optional<simulate::WindOptions> wind;
    std::optional<simulate::ContactOptions> contact;
    std::optional<simulate::SelfContactOptions> self_contact;
    simulate::LevelSetOptions level_set;
    std::optional<simulate::TableOptions> table;
    std::optional<simulate::SphereOptions> sphere;
    std::optional<simulate::PinOptions> pins;
    simulate::SolverOptions solver;
    simulate::ScheduleOptions path;
    simulate::GateOptions gate;
    simulate::LadderOptions ladder;
    std::optional<pattern::ImageOptions> image;
    skin::SplitOptions split;
    OutputConfig output;
    PredictConfig predict;
    EvaluateConfig evaluate;

    std::string file;           ///< the configuration's own path
    std::string text;           ///< what the data depend on, resolved, as TOML, paths as written
    std::string absolute_text;  ///< all of it, resolved, as TOML, paths absolute: works from any folder
    std::string hash;           ///< of the resolved values that the data depend on and the files they name
};

/// Reads and checks a scene. Throws Error (see files::ConfigFile), also where tables do not go together: an image
/// without a body, a body without contact.
SceneConfig read_scene(const std::string& path, const std::vector<std::string>& overrides);
/// The same from text that was kept elsewhere, its paths absolute; `source` stands for the file in messages.
SceneConfig read_scene_text(const std::string& text, const std::string& source,
                            const std::vector<std::string>& overrides);

/// What the scene does without, one sentence each: "no [bending]: no hinges are built".
std::vector<std::string> left_out(const SceneConfig& config);

}  // namespace toile::generate

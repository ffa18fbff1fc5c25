#pragma once

#include "files/config_file.h"
#include "generate/scene_config.h"

/// One function a group of tables: names every key, with its bounds, unit and documentation.
namespace toile::generate {

/// Words for an axis that points up, "auto" where it is to be found out.
files::ConfigChoices<std::string> axis_choices();

void bind_body(files::ConfigTable& root, SceneConfig& config);      ///< [body] and what is below it
void bind_poses(files::ConfigTable& root, SceneConfig& config);     ///< [poses], [poses.limits]; after the body
void bind_garment(files::ConfigTable& root, SceneConfig& config);   ///< [garment]
void bind_simulate(files::ConfigTable& root, SceneConfig& config);  ///< [material] to [ladder]
void bind_gate(files::ConfigTable& root, SceneConfig& config);      ///< [gate], [ladder]
void bind_dataset(files::ConfigTable& root, SceneConfig& config);   ///< [image], [split], [output]
/// [predict], [evaluate] and what is below it: nothing in them changes the data.
void bind_evaluation(files::ConfigTable& root, SceneConfig& config);

}  // namespace toile::generate

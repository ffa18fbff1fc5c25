#include "generate/scene_config.h"

#include "cloth/error.h"
#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigFile;
using files::ConfigTable;

namespace {

/// Tables that need another one: said at the place of the table that is there.
void check_needs(const ConfigTable& root, const SceneConfig& config) {
    for (const char* name : {"poses", "image", "level_set", "path", "split", "output", "predict", "evaluate"})
        if (root.has(name) && !config.body)
            throw Error(std::string("[") + name + "] needs [body], which this scene does not have", root.where(name));
    for (const char* name : {"body", "table", "sphere"})
        if (root.has(name) && !config.contact)
            throw Error(std::string("[") + name + "] needs [contact], which this scene does not have", root.where(name),
                        "add the line [contact]: its keys have defaults");
    if (config.contact && !config.body && !config.table && !config.sphere)
        throw Error("[contact] has nothing to touch", root.where("contact"),
                    "add [body], [table] or [sphere], or remove it");
    if (config.garment.source == GarmentSource::tshirt && !config.body)
        throw Error("garment.source is \"tshirt\", which is cut to a body, and this scene has no [body]",
                    root.where("garment"), "use \"patch\" or \"file\", or add [body]");
}

void left_out_of_evaluation(const EvaluateConfig& evaluate, std::vector<std::string>& line) {
    if (!evaluate.noise) line.push_back("no [evaluate.noise]: figures stand without the simulator's noise");
    if (!evaluate.runtime) line.push_back("no [evaluate.runtime]: no error against run time");
    if (!evaluate.stability) line.push_back("no [evaluate.stability]: no stiff and extreme cases");
    if (!evaluate.strain) line.push_back("no [evaluate.strain]: no strain analysis");
}

SceneConfig scene_of(const ConfigFile& file, const std::string& source) {
    SceneConfig config;
    config.file = source;
    ConfigTable root = file.root();
    ConfigTable scene = root.section("scene", "what this is");
    scene.text("name", config.name, "goes into the data set");
    scene.seed("seed", config.seed, "of the pose sampler and the split");
    bind_body(root, config);
    bind_poses(root, config);
    bind_garment(root, config);
    bind_simulate(root, config);
    bind_dataset(root, config);
    config.text = file.resolved(ConfigFile::Paths::written);
    config.hash = file.hash();
    bind_evaluation(root, config);
    config.absolute_text = file.resolved(ConfigFile::Paths::absolute);
    file.refuse_unknown_keys();
    check_needs(root, config);
    return config;
}

}  // namespace

SceneConfig read_scene(const std::string& path, const std::vector<std::string>& overrides) {
    return scene_of(ConfigFile(path, overrides), path);
}

SceneConfig read_scene_text(const std::string& text, const std::string& source,
                            const std::vector<std::string>& overrides) {
    return scene_of(ConfigFile::from_text(text, source, overrides), source);
}

std::vector<std::string> left_out(const SceneConfig& config) {
    std::vector<std::string> line;
    if (!config.body) line.push_back("no [body]: no skinning, no level set, no embedding");
    if (config.body && !config.poses) line.push_back("no [poses]: the neutral pose alone");
    if (!config.bending) line.push_back("no [bending]: no hinges");
    if (!config.strain_limit) line.push_back("no [strain_limit]: stretch is limited by stiffness alone");
    if (!config.wind) line.push_back("no [wind]: still air");
    if (!config.contact) line.push_back("no [contact]: no contact code");
    if (!config.self_contact) line.push_back("self_contact.enabled is false: layers pass through each other");
    if (config.self_contact && config.solver.solver == "bullet")
        line.push_back("solver bullet: it does not feel self-contact, crossings are only counted");
    if (!config.table) line.push_back("no [table]: no plane");
    if (!config.sphere) line.push_back("no [sphere]: no sphere");
    if (!config.pins) line.push_back("no [pins]: no vertex is held");
    if (!config.image) line.push_back("no [image]: no rasteriser");
    if (config.body && config.poses) left_out_of_evaluation(config.evaluate, line);
    return line;
}

}  // namespace toile::generate

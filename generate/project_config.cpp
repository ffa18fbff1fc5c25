#include "generate/project_config.h"

#include "cloth/error.h"
#include "files/config_file.h"

namespace toile::generate {

using files::ConfigFile;
using files::ConfigTable;

namespace {

using InextensibilityMethod = prior::InextensibilityOptions::Method;
using QuasistaticMethod = prior::QuasistaticOptions::Method;

void bind_inextensibility(ConfigTable& keys, ProjectConfig& config) {
    prior::InextensibilityOptions& options = config.inextensibility;
    keys.choice<InextensibilityMethod>(
        "method", options.method,
        {{"interior_point", InextensibilityMethod::interior_point}, {"cone", InextensibilityMethod::cone}},
        "cone: the paper's own route, for comparison");
    keys.real("stretch_limit", config.stretch_limit,
              {.lower = -1, .upper = 1e6, .above = true, .doc = "edges may be longer than at rest by this part"});
    keys.real("tolerance", options.tolerance, {.lower = 1e-10, .upper = 0.1, .doc = "relative optimality residual"});
    keys.integer("max_iterations", options.max_iterations, {.lower = 1, .doc = "second-order steps of a sample"});
}

void bind_quasistatic(ConfigTable& keys, ProjectConfig& config) {
    prior::QuasistaticOptions& options = config.quasistatic;
    keys.choice<QuasistaticMethod>("method", options.method,
                                   {{"fast", QuasistaticMethod::fast}, {"newton_cg", QuasistaticMethod::newton_cg}},
                                   "newton_cg: the paper's own route, for comparison");
    keys.real("mu", config.mu, {.lower = 0, .above = true, .doc = "stiffness of the springs to the prediction"});
    prior::QuasistaticStiffness& stiffness = config.stiffness;
    keys.real("stretch_stiffness", stiffness.stretch,
              {.lower = 0, .above = true, .unit = "N/m", .doc = "of edge springs"});
    keys.real("bending_stiffness", stiffness.bending, {.lower = 0, .unit = "N/m", .doc = "of bending springs"});
    keys.real("axial_stiffness", stiffness.axial, {.lower = 0, .unit = "N/m", .doc = "of axial springs"});
    keys.real("tolerance", options.tolerance, {.lower = 1e-12, .upper = 0.1, .doc = "relative optimality residual"});
    keys.integer("max_iterations", options.max_iterations, {.lower = 1, .doc = "second-order steps of a sample"});
}

const char* key_list(Prior prior) {
    return prior == Prior::inextensibility
               ? "keys: method, stretch_limit, tolerance, max_iterations"
               : "keys: method, mu, stretch_stiffness, bending_stiffness, axial_stiffness, tolerance, max_iterations";
}

}  // namespace

ProjectConfig read_project_config(Prior prior, const std::vector<std::string>& overrides) {
    try {
        const ConfigFile file(overrides);
        ProjectConfig config;
        config.prior = prior;
        ConfigTable keys = file.root();
        if (prior == Prior::inextensibility)
            bind_inextensibility(keys, config);
        else
            bind_quasistatic(keys, config);
        file.refuse_unknown_keys();
        config.text = file.resolved(ConfigFile::Paths::written);
        config.hash = file.hash();
        return config;
    } catch (const Error& error) {
        throw Error(error.what(), error.where(), key_list(prior));
    }
}

}  // namespace toile::generate

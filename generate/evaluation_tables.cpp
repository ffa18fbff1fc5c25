#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

namespace {

void bind_predict(ConfigTable& root, PredictConfig& predict) {
    ConfigTable table = root.section("predict", "built-in predictors, fitted on the train split");
    table.choices("predictor", predict.predictor, {"ridge", "nearest", "mean", "image"}, "the first is shown closest");
    table.integer_or("components", predict.components, "auto",
                     {.lower = 1, .upper = 10000, .doc = "of ridge; auto: by explained variance"});
    table.real("ridge", predict.ridge, {.lower = 0, .above = true, .doc = "its strength; else by cross-validation"});
    if (predict.predictor.empty()) table.fail("predictor", "is an empty list", "name at least one");
}

void bind_studies(ConfigTable& table, EvaluateConfig& evaluate) {
    if (auto noise = table.table("noise", "the simulator's own error")) {
        evaluate.noise.emplace();
        noise->real("share", evaluate.noise->share,
                    {.lower = 0, .upper = 1, .above = true, .doc = "of the poses; each is draped four times more"});
    }
    if (auto runtime = table.table("runtime", "error against run time")) {
        evaluate.runtime.emplace();
        runtime->choices("study", evaluate.runtime->study,
                         {"priors", "gradients", "solvers", "voxel", "image", "mesh", "batch"}, "what is swept");
        runtime->boolean("quick", evaluate.runtime->quick, "few settings and samples");
    }
    if (auto stability = table.table("stability", "stiff and extreme cases; they do not depend on the scene")) {
        evaluate.stability.emplace();
        stability->boolean("quick", evaluate.stability->quick, "those that take seconds");
    }
    if (auto strain = table.table("strain", "how the drapes are strained")) {
        evaluate.strain.emplace();
        strain->text("neighbourhood", evaluate.strain->neighbourhood, "of a vertex: ring:K, radius:METRES, nearest:N");
    }
}

}  // namespace

void bind_evaluation(ConfigTable& root, SceneConfig& config) {
    if (!config.body && !root.has("predict") && !root.has("evaluate")) return;
    bind_predict(root, config.predict);
    EvaluateConfig& evaluate = config.evaluate;
    ConfigTable table = root.section("evaluate", "what toile run measures of predictions and priors");
    table.reals("limit", evaluate.limit,
                {.lower = 0, .upper = 10, .doc = "stretch limits of the inextensibility prior"});
    table.reals("mu", evaluate.mu, {.lower = 1e-12, .upper = 1e12, .doc = "of the quasistatic prior"});
    table.choice<std::string>("learn_mu", evaluate.learn_mu,
                              {{"none", "none"}, {"global", "global"}, {"vertex", "vertex"}},
                              "on the train split, by gradient; vertex: one for all, then one a vertex");
    table.integer("samples", evaluate.samples, {.lower = 0, .doc = "at most this many of a split; 0: all"});
    table.integer("shown", evaluate.shown, {.lower = 0, .upper = 100, .doc = "samples in the report's view"});
    bind_studies(table, evaluate);
}

}  // namespace toile::generate

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace toile::generate {

/// [predict]: the built-in predictors that `toile run` fits on the train split.
struct PredictConfig {
    std::vector<std::string> predictor = {"ridge", "nearest", "mean", "image"};
    std::optional<int> components;  ///< of the principal components of `ridge`; empty: by explained variance
    std::optional<double> ridge;    ///< its strength; empty: by cross-validation on the train split
};

/// [evaluate.noise]: the simulator's own error, measured anew.
struct NoiseConfig {
    double share = 0.1;  ///< of the poses, above 0 to 1
};

/// [evaluate.runtime]: error against run time.
struct RuntimeConfig {
    std::vector<std::string> study = {"priors", "gradients", "solvers", "voxel", "image", "mesh", "batch"};
    bool quick = true;
};

/// [evaluate.stability]: the suites of stiff and extreme cases, which do not depend on the scene.
struct StabilityConfig {
    bool quick = true;
};

/// [evaluate.strain]: how the drapes of the data set are strained.
struct StrainConfig {
    std::string neighbourhood = "ring:1";
};

/// [evaluate]: what `toile run` measures of predictions and priors. What has no table below it is not done.
struct EvaluateConfig {
    std::vector<double> limit = {0.0, 0.02, 0.05, 0.1};  ///< stretch limits of the inextensibility prior
    std::vector<double> mu = {1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3};  ///< of the quasistatic prior
    std::string learn_mu = "vertex";                                        ///< none, global or vertex (and global)
    int samples = 0;                                                        ///< at most this many of a split; 0: all
    int shown = 12;                                                         ///< samples in the report's view
    std::optional<NoiseConfig> noise;
    std::optional<RuntimeConfig> runtime;
    std::optional<StabilityConfig> stability;
    std::optional<StrainConfig> strain;
};

}  // namespace toile::generate

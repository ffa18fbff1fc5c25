#pragma once

#include <string>
#include <vector>

#include "prior/inextensibility.h"
#include "prior/quasistatic.h"

namespace toile::generate {

enum class Prior { inextensibility, quasistatic };

/// Which prior, and its keys (contract, "Projection file").
struct ProjectConfig {
    Prior prior = Prior::inextensibility;
    double stretch_limit = 0.0;  ///< ε: an edge may be (1 + ε) times as long as at rest
    prior::InextensibilityOptions inextensibility;
    double mu = 0.1;  ///< of the target springs
    prior::QuasistaticStiffness stiffness;
    prior::QuasistaticOptions quasistatic;
    std::string text;  ///< the keys of the prior, resolved, as TOML with their bounds
    std::string hash;

    double tolerance() const {
        return prior == Prior::inextensibility ? inextensibility.tolerance : quasistatic.tolerance;
    }
};

/// Each override is `key=value`. Throws Error with `where` = "--set key" for an unknown key or a bad value; the mend
/// lists the keys.
ProjectConfig read_project_config(Prior prior, const std::vector<std::string>& overrides);

}  // namespace toile::generate

#pragma once

#include "app/commands.h"

namespace toile::app {

// One a subcommand of `toile evaluate`, as in app/commands.h.
void add_evaluate_stability(CLI::App& evaluate, Work& chosen);
void add_evaluate_strain(CLI::App& evaluate, Work& chosen);

}  // namespace toile::app

#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"
#include "files/replay_file.h"
#include "generate/replay.h"

/// What runs a case of the stability suites again: `toile simulate --replay FILE` a drape, `toile project PRIOR FILE` a
/// problem of the priors. The files lie in the folder `stability_replay` of the results.
namespace toile::evaluate {

/// Writes the replay of a drape that failed, whole or not at all, and names it in `outcome` with its command. `start`
/// is where the cloth set out and `end` where it came to; a case whose scene could not be built has neither and keeps
/// nothing. Solids, pins and material are not in the file: they are the case's own, and built anew from its name.
void keep_case(const std::string& folder, const StabilityScene* start, const simulate::DrapeResult* end,
               const StabilityBudget& budget, StabilityOutcome& outcome);

/// Writes the problem file of a problem some of whose samples failed, whole or not at all, and names it in those with
/// the command. Targets are those whose gradient is the one that was probed. Where μ varies by vertex the masses carry
/// it, which gives the same springs but for rounding.
void keep_problem(const std::string& folder, const StressProblem& problem, const StressDraw& draw, StressRoute route,
                  const StressSolution& solution, std::vector<StabilityOutcome>& outcomes);

/// Removes what earlier passes kept and no outcome names.
void remove_other_replays(const std::string& folder, const std::vector<StabilityOutcome>& outcomes);

/// Whether a file is the replay of a case of the suite, and not of a data set's pose.
bool is_case_replay(const std::string& path);

/// A case run again, and whether it passed this time.
struct ReplayedCase {
    generate::Replayed replayed;  ///< its drape is the last one
    StabilityOutcome outcome;
};

/// Runs the replay of a case again and writes the cloth as .obj, .ply or .glb. Overrides are of the table [case]:
/// name, solver, max_iterations, tries. Throws Error for a case that this program does not have.
ReplayedCase replay_case(const std::string& replay, const std::vector<std::string>& overrides, const std::string& path);

}  // namespace toile::evaluate

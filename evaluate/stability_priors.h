#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluate/stability.h"

/// The priors' part of the stability suites: random hard problems (evaluate/stress_problem.h), each sample a row.
namespace toile::evaluate {

/// "quasistatic/newton_cg"
std::string prior_solver(const std::string& prior, StressRoute route);

/// The name of a sample's case: "problem 12 of seed 1, sample 3: torn, tube of 345 vertices".
std::string prior_case_name(const StressProblem& problem, const StressDraw& draw, int sample);

/// Numbers of the problems of one prior that have a sample with `filter` in its name, and that a route is given.
std::vector<int> chosen_problems(const PriorSuite& suite, PriorKind prior, StressRoute route, bool quick,
                                 const std::string& filter);

/// One problem: an outcome for each of its samples whose name is `wanted`. Where one of them fails, the problem is kept
/// in `folder` (evaluate/stability_replay.h), unless that is empty. Never throws for what a prior makes of it.
std::vector<StabilityOutcome> run_prior_problem(const PriorSuite& suite, int number, StressRoute route,
                                                const std::function<bool(const std::string&)>& wanted,
                                                const std::string& folder);

}  // namespace toile::evaluate

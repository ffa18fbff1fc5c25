#pragma once

#include <functional>
#include <string>
#include <vector>

#include "simulate/options.h"

namespace toile::evaluate {

/// A solver in one of its settings. Those of a series go from quick to exact.
struct SolverSetting {
    std::string series;  ///< "implicit, tolerance"
    std::string solver;  ///< "implicit", "xpbd", "bullet"
    std::string name;    ///< "tolerance=1e-05"
    std::function<void(simulate::SolverOptions&, simulate::ScheduleOptions&)> change;

    void apply(simulate::SolverOptions& options, simulate::ScheduleOptions& schedule) const {
        options.solver = solver;
        change(options, schedule);
    }
};

enum class SettingChoice {
    quick,  ///< of the main series what takes little time
    main,   ///< of each solver the series that matters most for its error
    all
};
/// Steps and iterations of the three simulators, swept.
std::vector<SolverSetting> solver_settings(SettingChoice choice);

/// Where `implicit` comes to rest with far smaller steps and tolerances than any setting has: the reference.
void make_tightest(simulate::SolverOptions& options, simulate::ScheduleOptions& schedule);

}  // namespace toile::evaluate

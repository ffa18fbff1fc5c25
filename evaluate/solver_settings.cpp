#include "evaluate/solver_settings.h"

#include <spdlog/fmt/fmt.h>

namespace toile::evaluate {
namespace {

using simulate::ScheduleOptions;
using simulate::SolverOptions;

void add_implicit(std::vector<SolverSetting>& list) {
    for (const double tolerance : {1e-2, 5e-4, 1e-5})
        list.push_back({"implicit, tolerance", "implicit", fmt::format("tolerance={:.0e}", tolerance),
                        [tolerance](SolverOptions& solver, ScheduleOptions&) {
                            solver.residual_tolerance = tolerance;
                            solver.max_iterations = 5000;
                        }});
    for (const double part : {2.0, 1.0, 0.5})
        list.push_back({"implicit, step", "implicit", fmt::format("step={:g}", part),
                        [part](SolverOptions& solver, ScheduleOptions& schedule) {
                            solver.residual_tolerance = 1e-5;
                            solver.max_iterations = 5000;
                            solver.time_step *= part;
                            schedule.joint_step *= part;
                        }});
    for (const int iterations : {1, 3, 9})
        list.push_back({"implicit, iterations a path step", "implicit", fmt::format("path_iterations={}", iterations),
                        [iterations](SolverOptions& solver, ScheduleOptions& schedule) {
                            solver.residual_tolerance = 1e-5;
                            solver.max_iterations = 5000;
                            schedule.path_iterations = iterations;
                        }});
}

void add_others(std::vector<SolverSetting>& list) {
    for (const int substeps : {5, 20, 80})
        list.push_back({"xpbd, substeps", "xpbd", fmt::format("substeps={}", substeps),
                        [substeps](SolverOptions& solver, ScheduleOptions&) { solver.xpbd.substeps = substeps; }});
    for (const int iterations : {1, 4, 16})
        list.push_back({"xpbd, iterations", "xpbd", fmt::format("iterations={}", iterations),
                        [iterations](SolverOptions& solver, ScheduleOptions&) {
                            solver.xpbd.substeps = 5;
                            solver.xpbd.iterations = iterations;
                        }});
    for (const int refinement : {1, 2, 4, 8})
        list.push_back({"bullet, substep", "bullet", fmt::format("substep={:g}", 0.002 / refinement),
                        [refinement](SolverOptions& solver, ScheduleOptions&) {
                            solver.bullet.substep = 0.002 / refinement;
                            solver.bullet.settle_substeps *= refinement;
                        }});
    for (const int iterations : {2, 8, 32})
        list.push_back({"bullet, iterations", "bullet", fmt::format("iterations={}", iterations),
                        [iterations](SolverOptions& solver, ScheduleOptions&) {
                            solver.bullet.position_iterations = iterations;
                        }});
}

}  // namespace

std::vector<SolverSetting> solver_settings(SettingChoice choice) {
    std::vector<SolverSetting> list;
    add_implicit(list);
    add_others(list);
    std::erase_if(list, [choice](const SolverSetting& one) {
        const bool main_series =
            one.series == "implicit, tolerance" || one.series == "xpbd, substeps" || one.series == "bullet, substep";
        const bool slow = one.name == "tolerance=1e-05" || one.name == "substeps=80" || one.name == "substep=0.0005" ||
                          one.name == "substep=0.00025";
        return choice != SettingChoice::all && (!main_series || (choice == SettingChoice::quick && slow));
    });
    return list;
}

void make_tightest(SolverOptions& options, ScheduleOptions& schedule) {
    options.solver = "implicit";
    options.residual_tolerance = 1e-7;
    options.max_iterations = 20000;
    options.time_step *= 0.25;
    schedule.joint_step *= 0.25;
    schedule.path_tolerance *= 0.01;
    schedule.path_iterations = 30;
}

}  // namespace toile::evaluate

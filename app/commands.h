#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace toile::app {

/// What the command line asks for; returns the exit status.
using Work = std::function<int()>;

// One a command: declares its flags on `program`, and stores its work in `chosen` when the command line names it.
void add_run_command(CLI::App& program, Work& chosen);
void add_generate_command(CLI::App& program, Work& chosen);
void add_merge_command(CLI::App& program, Work& chosen);
void add_status_command(CLI::App& program, Work& chosen);
void add_skin_command(CLI::App& program, Work& chosen);
void add_simulate_command(CLI::App& program, Work& chosen);
void add_predict_command(CLI::App& program, Work& chosen);
void add_project_command(CLI::App& program, Work& chosen);
void add_evaluate_command(CLI::App& program, Work& chosen);
void add_report_command(CLI::App& program, Work& chosen);
void add_validate_command(CLI::App& program, Work& chosen);
void add_export_command(CLI::App& program, Work& chosen);
void add_config_command(CLI::App& program, Work& chosen);

// Subcommands of evaluate, likewise.
void add_evaluate_accuracy(CLI::App& evaluate, Work& chosen);
void add_evaluate_runtime(CLI::App& evaluate, Work& chosen);

}  // namespace toile::app

#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace toile::app {

/// Flags that several commands share.
struct Flags {
    std::string config;
    std::vector<std::string> overrides;  ///< --set
    std::string out;
    int jobs = 1;
    int pose = -1;
};

void add_config_flag(CLI::App& command, Flags& flags);  ///< CONFIG and --set
void add_jobs_flag(CLI::App& command, Flags& flags);
CLI::Option* add_pose_flag(CLI::App& command, Flags& flags, const std::string& doc);

}  // namespace toile::app

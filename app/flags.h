#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/progress.h"
#include "generate/generate.h"

namespace toile::app {

/// Flags that several commands share.
struct Flags {
    std::string config;
    std::vector<std::string> overrides;  ///< --set
    std::string out;
    int jobs = 1;
    std::string shard;  ///< "3/16"
    bool resume = false;
    std::uint64_t memory_limit = 0;  ///< [bytes]
    int pose = -1;
    std::string replay;
};

/// CONFIG, which is required, and --set.
CLI::Option* add_config_flag(CLI::App& command, Flags& flags);
/// Those of a data set: CONFIG, --set, --out, --jobs, --resume, --memory-limit.
void add_generate_flags(CLI::App& command, Flags& flags);
void add_shard_flag(CLI::App& command, Flags& flags);
void add_jobs_flag(CLI::App& command, Flags& flags);
CLI::Option* add_pose_flag(CLI::App& command, Flags& flags, const std::string& doc);

/// What the flags of a data set ask for; from now on an interrupt ends the work in order.
generate::GenerateOptions generate_options(const Flags& flags, ProgressDisplay& display);

}  // namespace toile::app

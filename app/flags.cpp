#include "app/flags.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <thread>

#include "app/command_line.h"
#include "app/interrupt.h"
#include "cloth/error.h"

namespace toile::app {

CLI::Option* add_config_flag(CLI::App& command, Flags& flags) {
    CLI::Option* config = command.add_option("CONFIG", flags.config, "the scene, in TOML")->required();
    command
        .add_option("--set", flags.overrides,
                    "overrides one key of the configuration, for example --set poses.count=4; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    return config;
}

void add_generate_flags(CLI::App& command, Flags& flags) {
    add_config_flag(command, flags);
    command.add_option("--out", flags.out, "folder for the data set; made if it is not there")
        ->type_name("DIR")
        ->required();
    add_jobs_flag(command, flags);
    command.add_flag("--resume", flags.resume,
                     "goes on with what is in DIR: makes what is missing, damaged, crashed or ran out of memory");
    command
        .add_option("--memory-limit", flags.memory_limit,
                    "memory that one worker process may take, for example 4GB; a pose that needs more fails alone")
        ->type_name("SIZE")
        ->transform(CLI::AsSizeValue(false))
        ->transform([](const std::string& text) {  // which AsSizeValue would let wrap around
            if (text.find('-') != std::string::npos) throw CLI::ValidationError("--memory-limit", "is negative");
            return text;
        });
}

void add_shard_flag(CLI::App& command, Flags& flags) {
    command
        .add_option("--shard", flags.shard, "makes part I of N alone, I from 0 to N - 1; toile merge DIR joins them")
        ->type_name("I/N")
        // an unset variable of a job script, which would else ask for the whole corpus
        ->check([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); });
}

void add_jobs_flag(CLI::App& command, Flags& flags) {
    flags.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    command.add_option("--jobs", flags.jobs, "samples worked on side by side; the files do not depend on it")
        ->type_name("N")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
}

CLI::Option* add_pose_flag(CLI::App& command, Flags& flags, const std::string& doc) {
    return command.add_option("--pose", flags.pose, doc)
        ->type_name("K")
        ->check(CLI::Range(0, std::numeric_limits<int>::max()));
}

namespace {

std::optional<generate::ShardNumber> shard_of(const std::string& text) {
    if (text.empty()) return std::nullopt;
    generate::ShardNumber shard;
    int read = 0;
    constexpr int most = 99999;
    if (std::sscanf(text.c_str(), "%d/%d%n", &shard.index, &shard.count, &read) != 2 ||
        read != static_cast<int>(text.size()) || shard.count < 1 || shard.count > most || shard.index < 0 ||
        shard.index >= shard.count)
        throw Error("--shard is " + text + ", but should be I/N with I from 0 to N - 1", "command line",
                    "the first of sixteen shards is 0/16, the last 15/16");
    return shard;
}

}  // namespace

generate::GenerateOptions generate_options(const Flags& flags, ProgressDisplay& display) {
    generate::GenerateOptions options;
    options.folder = flags.out;
    options.jobs = flags.jobs;
    options.shard = shard_of(flags.shard);
    options.resume = flags.resume;
    options.command = command_line();
    options.memory_limit = flags.memory_limit;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    return options;
}

}  // namespace toile::app

#include "app/flags.h"

#include <algorithm>
#include <limits>
#include <thread>

#include "app/interrupt.h"

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

generate::GenerateOptions generate_options(const Flags& flags, ProgressDisplay& display) {
    generate::GenerateOptions options;
    options.folder = flags.out;
    options.jobs = flags.jobs;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    return options;
}

}  // namespace toile::app

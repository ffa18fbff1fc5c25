#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/guard.h"
#include "app/progress.h"

namespace {

/// Parses the command line. Returns an exit status where nothing is left to do, else -1 with the work in `chosen`.
int parse(int argc, char** argv, toile::app::Work& chosen) {
    CLI::App program("toile: training data of draped cloth, from joint angles", "toile");
    program.set_version_flag("--version", "toile " TOILE_VERSION);
    program.require_subcommand(1);
    program.footer("toile COMMAND --help explains each command.\n\n  toile run configs/quick.toml --out out/quick");
    toile::app::add_run_command(program, chosen);
    toile::app::add_generate_command(program, chosen);
    toile::app::add_merge_command(program, chosen);
    toile::app::add_status_command(program, chosen);
    toile::app::add_skin_command(program, chosen);
    toile::app::add_simulate_command(program, chosen);
    toile::app::add_predict_command(program, chosen);
    toile::app::add_project_command(program, chosen);
    toile::app::add_evaluate_command(program, chosen);
    toile::app::add_report_command(program, chosen);
    toile::app::add_validate_command(program, chosen);
    toile::app::add_export_command(program, chosen);
    toile::app::add_config_command(program, chosen);
    const auto known =
        program.get_subcommands([&](const CLI::App* one) { return argc > 1 && one->check_name(argv[1]); });
    if (argc > 1 && argv[1][0] != '-' && known.empty()) {
        toile::app::print_error("there is no command " + std::string(argv[1]), "command line",
                                "toile --help lists the commands");
        return toile::app::input_at_fault;
    }
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& success) {  // --help, --version
        return program.exit(success);
    } catch (const CLI::ParseError& error) {
        toile::app::print_error(error.what(), "command line", "toile --help lists the commands and flags");
        return toile::app::input_at_fault;
    }
    return -1;
}

}  // namespace

int main(int argc, char** argv) {
    // Beyond a limit on file sizes writes then fail with a reason, as they do on a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
    toile::app::log_to_stderr();
    toile::app::keep_command_line(argc, argv);
    const int status = toile::app::guarded([&] {
        toile::app::Work work;
        const int parsed = parse(argc, argv, work);
        return parsed >= 0 ? parsed : work();
    });
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
    toile::app::print_error(std::string("cannot write the output: ") + std::strerror(errno), "stdout", {});
    return status == toile::app::all_done ? toile::app::input_at_fault : status;
}

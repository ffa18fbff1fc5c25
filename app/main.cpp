#include <cstdio>

#include "app/commands.h"
#include "app/guard.h"

namespace {

/// Parses the command line. Returns an exit status where nothing is left to do, else -1 with the work in `chosen`.
int parse(int argc, char** argv, toile::app::Work& chosen) {
    CLI::App program("toile: training data of draped cloth, from joint angles", "toile");
    program.set_version_flag("--version", "toile " TOILE_VERSION);
    program.require_subcommand(1);
    program.footer("toile COMMAND --help explains each command.\n\n  toile run configs/quick.toml --out out/quick");
    toile::app::add_run_command(program, chosen);
    toile::app::add_generate_command(program, chosen);
    toile::app::add_skin_command(program, chosen);
    toile::app::add_simulate_command(program, chosen);
    toile::app::add_validate_command(program, chosen);
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
    return toile::app::guarded([&] {
        toile::app::Work work;
        const int status = parse(argc, argv, work);
        return status >= 0 ? status : work();
    });
}

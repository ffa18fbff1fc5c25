#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/guard.h"
#include "generate/corpus_status.h"

namespace toile::app {
namespace {

using generate::ShardState;

template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    std::puts(fmt::format(format, std::forward<Args>(args)...).c_str());
}

/// "45 s", "12 min", "3 h 20 min", "2 d 5 h"
std::string duration_text(double seconds) {
    if (seconds < 90) return fmt::format("{:.0f} s", seconds);
    const auto minutes = static_cast<std::int64_t>(seconds / 60 + 0.5);
    if (minutes < 90) return fmt::format("{} min", minutes);
    if (minutes < 48 * 60) return fmt::format("{} h {} min", minutes / 60, minutes % 60);
    return fmt::format("{} d {} h", minutes / (24 * 60), minutes / 60 % 24);
}

void print_shard(const generate::ShardStatus& s, const std::string& folder) {
    if (s.state == ShardState::not_begun || s.state == ShardState::finished) return;
    const std::string number = fmt::format("{}/{}", s.number.index, s.number.count);
    const std::string process = s.host.empty() ? "" : fmt::format(", process {} on {}", s.pid, s.host);
    say("  shard {:<10} {}, {} of {} done{}{}", number, generate::shard_state_name(s.state), s.done, s.samples,
        s.rate > 0 ? fmt::format(", {:.2f} a second", s.rate) : "", process);
    if (s.state == ShardState::running) return;
    if (s.state == ShardState::stale) say("                   it says that it is running, but nobody holds its lock");
    say("  go on with it    toile generate {0}/config.toml --out {0} --shard {1} --resume", folder, number);
}

void print_status(const generate::CorpusStatus& s) {
    say("{}", s.folder);
    if (s.planning) return say("  planning         the neutral drape, the splits, the size of the images");
    say("  samples          {} of {} done ({:.1f} %), {} accepted", s.done, s.samples,
        s.samples > 0 ? 100.0 * static_cast<double>(s.done) / static_cast<double>(s.samples) : 100.0, s.accepted);
    for (const auto& [reason, count] : s.failed) say("  not accepted     {}: {}", reason, count);
    if (s.rate > 0) say("  rate             {:.3g} samples a second", s.rate);
    if (s.done < s.samples)
        say("  time left        {}", s.seconds_left ? duration_text(*s.seconds_left) : "not known: nothing is running");
    if (!s.shard.empty())
        say("  shards           {}: {} finished, {} running, {} stopped, {} stale, {} not begun", s.shard.size(),
            s.count(ShardState::finished), s.count(ShardState::running), s.count(ShardState::stopped),
            s.count(ShardState::stale), s.count(ShardState::not_begun));
    for (const generate::ShardStatus& one : s.shard) print_shard(one, s.folder);
    if (s.dataset_samples) say("  dataset.h5       holds {} samples", *s.dataset_samples);
}

struct StatusFlags {
    std::string folder;
    bool json = false;
};

int show_status(const StatusFlags& flags) {
    const generate::CorpusStatus status = generate::corpus_status(flags.folder);
    if (flags.json)
        std::puts(generate::status_json(status).c_str());
    else
        print_status(status);
    return all_done;
}

}  // namespace

void add_status_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("status", "how far the corpus in DIR has come, over all its shards");
    const auto flags = std::make_shared<StatusFlags>();
    command->add_option("DIR", flags->folder, "the folder that toile generate writes to")->required();
    command->add_flag("--json", flags->json, "for scripts: one JSON object");
    command->footer(
        "Changes nothing, and may be asked at any time. The rate is that of the shards that run, by their own "
        "clocks.\n\n"
        "  toile status out/big\n"
        "  toile status out/big --json");
    command->callback([flags, &chosen] { chosen = [flags] { return show_status(*flags); }; });
}

}  // namespace toile::app

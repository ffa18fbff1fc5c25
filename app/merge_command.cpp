#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <map>
#include <memory>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "generate/dataset_card.h"
#include "generate/export.h"
#include "generate/merge.h"

namespace toile::app {
namespace {

template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    std::puts(fmt::format(format, std::forward<Args>(args)...).c_str());
}

/// A reader that goes through all of the data set keeps this many files open; many systems allow 1024.
constexpr int many_parts = 500;

void print_merge(const generate::MergeSummary& s, const std::string& folder, bool copy) {
    say("{}", s.dataset.empty() ? folder : s.dataset);
    say("  samples          {} from {} parts in {} shards, {} accepted{}", s.samples, s.parts, s.shards, s.accepted,
        copy || s.dataset.empty() ? "" : "; they stay in the shards");
    std::map<std::string, std::vector<std::int64_t>> pose;
    for (const generate::FailedSample& one : s.failed) pose[one.reason].push_back(one.pose);
    for (const auto& [reason, list] : pose)
        say("  not accepted     {}: {}, poses {}", reason, list.size(), generate::ranges_text(list));
    for (const generate::FailedSample& one : s.failed)
        if (!one.replay.empty()) say("  run again        toile simulate --replay {} --out pose.obj", one.replay);
    if (!s.missing.empty())
        say("  missing          {} samples, poses {}", s.missing.size(), generate::ranges_text(s.missing));
    for (const std::string& line : s.damaged) say("  damaged          {}", line);
    if (!s.missing.empty() || !s.damaged.empty())
        say("  fill the gaps    toile generate {0}/config.toml --out {0} --resume", folder);
    if (s.dataset.empty()) say("  note             nothing was written");
    if (!copy && s.parts > many_parts)
        say("  note             other programs that read all of it keep {} files open; --copy makes one file", s.parts);
}

int merge_shards(const std::string& folder, bool copy) {
    generate::MergeOptions options;
    ProgressDisplay display;
    options.copy = copy;
    options.progress = [&](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const generate::MergeSummary summary = generate::merge(folder, options);
    display.finish();
    if (!summary.dataset.empty()) {
        generate::write_card(summary.dataset, {command_line(), {}});
        generate::write_xdmf(summary.dataset);
    }
    print_merge(summary, folder, copy);
    return summary.is_complete() ? all_done : some_samples_failed;
}

struct MergeFlags {
    std::string folder;
    bool copy = false;
};

}  // namespace

void add_merge_command(CLI::App& program, Work& chosen) {
    CLI::App* command =
        program.add_subcommand("merge", "join the shards in DIR into one data set, DIR/dataset.h5, with its card");
    const auto flags = std::make_shared<MergeFlags>();
    command->add_option("DIR", flags->folder, "the folder that toile generate --shard wrote to")->required();
    command->add_flag(
        "--copy", flags->copy,
        "copies the samples into one file, the same that a single run makes; else it refers to the shards");
    command->footer(
        "Every sample is read and its digest checked. What is missing, damaged or not accepted is listed, and the "
        "exit\n"
        "status is then 3; what is sound is joined. May be run as often as one likes, also while shards are at "
        "work.\n\n"
        "  toile merge out/big\n"
        "  toile merge out/big --copy");
    command->callback([flags, &chosen] { chosen = [flags] { return merge_shards(flags->folder, flags->copy); }; });
}

}  // namespace toile::app

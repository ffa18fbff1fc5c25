#include "generate/merge.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cloth/error.h"
#include "files/dataset_header.h"
#include "files/dataset_join.h"
#include "files/plan_file.h"
#include "generate/ordered_work.h"
#include "generate/shard.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

/// A sealed part that can be read.
struct Part {
    std::string path;
    int first_slot = 0;
    std::vector<char> sound;  ///< by row

    int end_slot() const { return first_slot + static_cast<int>(sound.size()); }
};

/// One run: what its stages share.
struct Run {
    const std::string& folder;
    const MergeOptions& options;
    files::CorpusPlan plan;
    std::vector<Part> part = {};  ///< in the order of the corpus
    SampleTally tally = {};
    std::vector<std::string> damaged = {};
    int checked = 0, joined = 0;

    std::string name_of(const std::string& path) const { return fs::path(path).lexically_relative(folder).string(); }
    void step(std::string_view stage, int done, int total) const {
        if (options.interrupted && *options.interrupted) throw Interrupted("interrupted: nothing was joined");
        if (options.progress) options.progress({stage, done, total, static_cast<int>(tally.failed.size())});
    }
};

files::CorpusPlan plan_of(const std::string& folder) {
    const fs::path path = fs::path(folder) / "plan.h5";
    if (!fs::exists(path))
        throw Error("this folder holds no shards to join: it has no plan.h5", folder,
                    "give the folder that toile generate --shard wrote to");
    return files::read_plan(path.string());
}

std::vector<ShardNumber> shards_of_one_division(const std::string& folder) {
    const std::vector<ShardNumber> shard = shards_in(folder);
    if (shard.empty())
        throw Error("this folder holds no shards to join", folder,
                    "toile generate CONFIG --out DIR --shard I/N makes one");
    if (shard.front().count != shard.back().count)
        throw Error("the folder holds shards of two divisions, into " + std::to_string(shard.front().count) +
                        " and into " + std::to_string(shard.back().count),
                    (fs::path(folder) / shard_folder_name(shard.back())).string(),
                    "keep the shards of one division here and move the others elsewhere");
    return shard;
}

/// The sealed parts in a shard's folder, in order.
std::vector<std::string> sealed_parts(const fs::path& folder) {
    std::vector<std::pair<int, std::string>> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        int number = -1, length = 0;
        const std::string name = entry.path().filename().string();
        if (std::sscanf(name.c_str(), "part_%d.h5%n", &number, &length) == 1 && length > 0 &&
            static_cast<size_t>(length) == name.size())
            found.emplace_back(number, entry.path().string());
    }
    std::sort(found.begin(), found.end());
    std::vector<std::string> path;
    for (auto& [number, one] : found) path.push_back(std::move(one));
    return path;
}

/// Error unless the part can belong to the corpus.
void check_owner(const files::DatasetReader& reader, ShardNumber shard, const files::CorpusPlan& plan) {
    const auto refuse = [&](const std::string& what, const std::string& mend) {
        throw Error("this part belongs to another corpus: " + what, reader.file().path(), mend);
    };
    const std::string elsewhere = "move it out of the folder, or give it a folder of its own with its plan.h5";
    const files::DatasetHeader& header = reader.header();
    if (header.config_hash != plan.header.config_hash)
        refuse("its configuration has the hash " + header.config_hash + ", the plan's " + plan.header.config_hash,
               elsewhere);
    if (header.program_version != plan.header.program_version)
        refuse("toile " + header.program_version + " made it, and toile " + plan.header.program_version + " the plan",
               "make all shards with one version");
    if (!reader.part()) refuse("it is a data set by itself", elsewhere);
    const files::CorpusPart& place = *reader.part();
    if (place.corpus_samples != plan.sample_count())
        refuse("of " + std::to_string(place.corpus_samples) + " samples, the plan has " +
                   std::to_string(plan.sample_count()),
               elsewhere);
    if (place.shard != shard.index || place.shards != shard.count)
        refuse("it is from " + shard_folder_name({place.shard, place.shards}), "put it back there");
    const SlotRange range = shard_slots(shard, plan.sample_count());
    if (place.first_slot < range.first || place.first_slot + reader.sample_count() > range.end)
        refuse("its samples are not its shard's", elsewhere);
    const std::string difference = files::header_difference(header, plan.header);
    if (!difference.empty())
        refuse("its " + difference + " differs from the plan's", "make all shards with the plan.h5 of this folder");
}

/// What is wrong with a sample, or nothing. Fills in its arrays.
std::string damage_of(const files::DatasetReader& reader, int row, const files::Digest& digest,
                      files::SampleRecord& sample) {
    try {
        reader.read_arrays(row, sample);
    } catch (const Error& error) {
        return error.what();
    }
    return files::sample_digest(sample) == digest ? "" : "its digest does not match its bytes";
}

void check_samples(Run& run, const files::DatasetReader& reader, Part& part) {
    const int count = reader.sample_count();
    std::vector<files::SampleRecord> sample = reader.read_columns(0, count);
    const std::vector<files::Digest> digest = reader.stored_digests(0, count);
    part.sound.assign(static_cast<size_t>(count), 0);
    for (int row = 0; row < count; ++row) {
        const std::int64_t pose = run.plan.pose_number[part.first_slot + row];
        const std::string damage = run.options.trust ? "" : damage_of(reader, row, digest[row], sample[row]);
        if (!damage.empty()) {
            run.damaged.push_back("pose " + std::to_string(pose) + " in " + run.name_of(part.path) + ": " + damage);
        } else if (sample[row].id != pose || sample[row].split != run.plan.split[part.first_slot + row]) {
            throw Error("this part belongs to another corpus: it holds pose " + std::to_string(sample[row].id) +
                            " where the plan has pose " + std::to_string(pose) + ", or another split of it",
                        part.path, "make all shards with the plan.h5 of this folder");
        } else {
            part.sound[row] = 1;
            run.tally.add(sample[row], run.folder);
            ++run.joined;
        }
        sample[row] = {};
        run.step("checking", ++run.checked, run.plan.sample_count());
    }
}

void check_part(Run& run, ShardNumber shard, const std::string& path) {
    std::unique_ptr<files::DatasetReader> reader;
    try {
        reader = std::make_unique<files::DatasetReader>(path);
    } catch (const Error& error) {
        run.damaged.push_back(run.name_of(path) + ": " + error.what());
        return;
    }
    check_owner(*reader, shard, run.plan);
    Part part{path, static_cast<int>(reader->part()->first_slot), {}};
    if (!run.part.empty() && part.first_slot < run.part.back().end_slot())
        throw Error("this part holds samples that " + run.name_of(run.part.back().path) + " holds too", path,
                    "keep one of the two");
    check_samples(run, *reader, part);
    run.part.push_back(std::move(part));
}

std::vector<std::int64_t> missing_poses(const Run& run) {
    std::vector<std::int64_t> missing;
    int next = 0;
    const auto up_to = [&](int end) {
        for (int slot = next; slot < end; ++slot) missing.push_back(run.plan.pose_number[slot]);
    };
    for (const Part& part : run.part) {
        up_to(part.first_slot);
        next = part.end_slot();
    }
    up_to(run.plan.sample_count());
    return missing;
}

void write_dataset(const Run& run, const std::string& path) {
    const int deflate = files::Hdf5File::open(run.part.front().path).deflate("/samples/cloth");
    files::DatasetJoin joined(path, run.plan.header, run.joined, deflate,
                              run.options.copy ? files::DatasetJoin::How::copy : files::DatasetJoin::How::refer);
    int done = 0;
    for (const Part& part : run.part) {
        const files::DatasetReader reader(part.path);
        const std::vector<files::SampleRecord> columns = reader.read_columns(0, reader.sample_count());
        const std::vector<files::Digest> digest = reader.stored_digests(0, reader.sample_count());
        for (int row = 0; row < reader.sample_count(); ++row) {
            if (!part.sound[row]) continue;
            joined.add(reader, row, columns[row], digest[row]);
            run.step("joining", ++done, run.joined);
        }
    }
    joined.finish();
}

}  // namespace

MergeSummary merge(const std::string& folder, const MergeOptions& options) {
    Run run{folder, options, plan_of(folder)};
    const std::vector<ShardNumber> shards = shards_of_one_division(folder);
    for (const ShardNumber shard : shards)
        for (const std::string& path : sealed_parts(fs::path(folder) / shard_folder_name(shard)))
            check_part(run, shard, path);
    MergeSummary summary;
    summary.shards = static_cast<int>(shards.size());
    summary.parts = static_cast<int>(run.part.size());
    summary.samples = run.joined;
    summary.accepted = static_cast<int>(run.tally.accepted);
    summary.failed = run.tally.failed;
    for (FailedSample& one : summary.failed)
        if (!fs::exists(one.replay)) one.replay.clear();
    summary.missing = missing_poses(run);
    summary.damaged = run.damaged;
    if (run.joined == 0) return summary;
    summary.dataset = (fs::path(folder) / "dataset.h5").string();
    write_dataset(run, summary.dataset);
    return summary;
}

std::string ranges_text(const std::vector<std::int64_t>& number) {
    std::string text;
    for (size_t first = 0, last = 0; first < number.size(); first = ++last) {
        while (last + 1 < number.size() && number[last + 1] == number[last] + 1) ++last;
        text += (text.empty() ? "" : ", ") + std::to_string(number[first]);
        if (last > first) text += (last > first + 1 ? " to " : ", ") + std::to_string(number[last]);
    }
    return text;
}

}  // namespace toile::generate

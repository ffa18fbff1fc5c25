#pragma once

#include <filesystem>
#include <string>

#include "files/plan_file.h"
#include "generate/shard.h"

namespace toile::test {

/// DIR/shard_00003_of_00016/part_00001.h5
inline std::string part_path(const std::string& folder, generate::ShardNumber shard, int part) {
    char name[32];
    std::snprintf(name, sizeof name, "part_%05d.h5", part);
    return (std::filesystem::path(folder) / generate::shard_folder_name(shard) / name).string();
}

/// The samples of a shard in sealed parts, as `generate` leaves them, taken from a data set of all.
inline void write_shard(const std::string& single, const std::string& folder, generate::ShardNumber shard,
                        int part_samples) {
    const files::DatasetReader reader(single);
    const generate::SlotRange slots = generate::shard_slots(shard, reader.sample_count());
    std::filesystem::create_directories(std::filesystem::path(part_path(folder, shard, 0)).parent_path());
    for (int part = 0; part * part_samples < slots.size(); ++part) {
        const int first = slots.first + part * part_samples, count = std::min(part_samples, slots.end - first);
        files::DatasetWriter writer(part_path(folder, shard, part), reader.header(), count, 4,
                                    files::CorpusPart{shard.index, shard.count, first, reader.sample_count()});
        for (int row = 0; row < count; ++row) writer.write(row, reader.read(first + row));
        writer.finish();
    }
}

/// DIR/plan.h5 of the samples of a data set.
inline void write_plan_of(const std::string& single, const std::string& folder) {
    const files::DatasetReader reader(single);
    files::CorpusPlan plan;
    plan.header = reader.header();
    for (int slot = 0; slot < reader.sample_count(); ++slot) {
        plan.pose_number.push_back(reader.read(slot).id);
        plan.split.push_back(reader.read(slot).split);
    }
    std::filesystem::create_directories(folder);
    files::write_plan((std::filesystem::path(folder) / "plan.h5").string(), plan);
}

/// A data set cut into a plan and shards.
inline void write_corpus(const std::string& single, const std::string& folder, int shards, int part_samples) {
    write_plan_of(single, folder);
    for (int index = 0; index < shards; ++index) write_shard(single, folder, {index, shards}, part_samples);
}

}  // namespace toile::test

#include "generate/shard_progress.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::generate {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ShardProgress, shard, shards, samples, done, accepted, failed, made_here,
                                   seconds_here, pid, host, state, updated)

void write_shard_progress(const std::string& path, const ShardProgress& progress) {
    files::write_text_file(path, nlohmann::json(progress).dump() + "\n", files::NewFile::Survives::kill);
}

ShardProgress read_shard_progress(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw Error("cannot read the shard's progress", path);
    try {
        return nlohmann::json::parse(file).get<ShardProgress>();
    } catch (const std::exception& error) {  // a folder by that name is the stream's to refuse
        throw Error(std::string("this is not a shard's progress: ") + error.what(), path);
    }
}

}  // namespace toile::generate

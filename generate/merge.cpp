#include "generate/merge.h"

#include <filesystem>

#include "files/plan_file.h"
#include "generate/shard.h"
namespace toile::generate {
MergeSummary merge(const std::string& folder, const MergeOptions&) {
    const files::CorpusPlan plan = files::read_plan(folder + "/plan.h5");
    MergeSummary s;
    s.dataset = folder + "/dataset.h5";
    files::DatasetWriter w(s.dataset, plan.header, plan.sample_count(), 4);
    int slot = 0;
    for (auto n : shards_in(folder))
        for (int p = 0;; ++p) {
            char name[32];
            std::snprintf(name, sizeof name, "part_%05d.h5", p);
            auto path = std::filesystem::path(folder) / shard_folder_name(n) / name;
            if (!std::filesystem::exists(path)) break;
            files::DatasetReader r(path.string());
            for (int k = 0; k < r.sample_count(); ++k) w.write(slot++, r.read(k));
        }
    w.finish();
    return s;
}
}  // namespace toile::generate

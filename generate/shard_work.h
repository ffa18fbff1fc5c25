#pragma once

#include "generate/corpus_plan.h"
#include "generate/shard.h"

namespace toile::generate {

/// Fills a shard: makes the samples that are missing in `options.jobs` worker processes, and says how far it has come
/// in progress.json. A sample whose worker ends twice is stored as failed. Throws Interrupted, and Error as
/// `Shard::add` does; what was added is kept.
void fill_shard(Shard& shard, const SceneConfig& config, const files::CorpusPlan& plan, const std::string& folder,
                const PlanOptions& options);

}  // namespace toile::generate

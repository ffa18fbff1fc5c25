#pragma once

#include <atomic>
#include <map>
#include <string>

#include "files/plan_file.h"
#include "generate/progress.h"
#include "generate/scene_config.h"

namespace toile::generate {

struct PlanOptions {
    int jobs = 1;
    std::uint64_t memory_limit = 0;  ///< of a worker process [bytes]; 0: none
    ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;
};

/// The plan of a corpus, from `folder`/plan.h5 or made now: the garment draped in the neutral pose, the splits, and the
/// size of the images. `image.size = "auto"` is chosen on `image.probe` poses spread evenly over all, so that it does
/// not depend on who makes which sample; their drapes are kept in `folder`/probe and become samples later. One process
/// makes the plan, others that ask meanwhile wait for it. The work is done in child processes.
///
/// Throws Error where the folder's plan is that of another configuration or program version, and as `dress` does.
files::CorpusPlan corpus_plan(const SceneConfig& config, const std::string& folder, const PlanOptions& options);

/// Slots that the size of the images is chosen on.
std::vector<int> probe_slots(int samples, int probe);

/// The samples, without their images, that planning made: slot -> files::sample_bytes.
std::map<int, std::string> probed_samples(const std::string& folder, const files::CorpusPlan& plan);

/// Removes what planning left in the folder.
void remove_plan(const std::string& folder);

}  // namespace toile::generate

#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "generate/worker_process.h"

namespace toile::generate {

struct WorkerPoolOptions {
    int workers = 1;
    std::uint64_t memory_limit =
        0;  ///< bytes of writable memory each worker may map, with what it was forked with; 0: no limit
    const std::atomic<bool>* interrupted = nullptr;
    /// Descriptors of the parent that workers close at once: that of a lock, which is held as long as any process has
    /// it.
    std::vector<int> parents_descriptor;
};

enum class WorkerFailure { crashed, out_of_memory };

struct WorkResult {
    int index = 0;
    std::string bytes;                     ///< empty after a failure
    std::optional<WorkerFailure> failure;  ///< what the second try ended with
    std::string detail;                    ///< of the failure, such as "signal 11 (Segmentation fault)"
};

/// Makes the bytes of each of `index` in forked worker processes, so that an index that brings its process down costs
/// itself only. Hands each result to `take` as it comes: indices are handed out in their order, and come back in any.
/// At most two indices a worker are under way, one of them in work. `idle` is called about once a second.
///
/// The caller must have one thread. The workers share nothing but what was in memory when they were forked, which is at
/// any time during the call.
///
/// An index is tried again, once, in a new process where its first one died (`crashed`) or ran out of memory:
/// an allocation failed, or SIGKILL, which the kernel sends where its memory is used up. After the latter it is tried
/// while no other index is in work. So is an index with an exception that is no toile::Error: a failure of ours on this
/// input. It is `crashed`.
///
/// Throws the toile::Error that `start` or `make` threw in a worker; Error where two workers in a row run out of memory
/// in `start` or cannot be forked, std::runtime_error where they die there of anything else; Interrupted as soon as
/// `interrupted` is set; and what `take` and `idle` throw. No process is left behind, even if the caller is killed.
void run_in_workers(const std::vector<int>& index, const WorkerPoolOptions& options, const StartWorker& start,
                    const std::function<void(WorkResult)>& take, const std::function<void()>& idle = {});

}  // namespace toile::generate

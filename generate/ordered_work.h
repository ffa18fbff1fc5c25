#pragma once

#include <atomic>
#include <functional>
#include <stdexcept>

#include "files/dataset_file.h"

namespace toile::generate {

/// Someone asked the work to end.
struct Interrupted : std::runtime_error {
    explicit Interrupted(const char* what = "interrupted: no data set was written") : std::runtime_error(what) {}
};

/// Makes records 0 .. count - 1 from `jobs` threads and hands each to `take` in index order, one thread at a time. A
/// thread that is far ahead of the slowest record waits, so at most 4 `jobs` records are in memory. Throws the first
/// exception of `make` or `take`, and Interrupted once `interrupted` is set.
void make_in_order(int count, int jobs, const std::function<files::SampleRecord(int index)>& make,
                   const std::function<void(int index, files::SampleRecord record)>& take,
                   const std::atomic<bool>* interrupted);

}  // namespace toile::generate

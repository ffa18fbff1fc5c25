#pragma once

#include <functional>

namespace toile::bench {

/// Runs `work` in a child process and gives its largest resident size [MB], libraries and all; -1 if it failed. To be
/// called before this process has used much memory itself: a child starts with its parent's pages.
double peak_memory_of(const std::function<bool()>& work);

}  // namespace toile::bench

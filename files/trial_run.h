#pragma once

#include <functional>
#include <string>

namespace toile::files {

/// Runs `read` in a child process first, so that a library that aborts, crashes or never ends on a damaged file takes
/// the child down and not us. Throws Error naming `path` if the child did not come to an end by itself within
/// `cpu_seconds`; what `read` returns or throws there is of no concern. Internal to files/.
void trial_run(const std::string& path, int cpu_seconds, const std::function<void()>& read);

}  // namespace toile::files

#pragma once

#include <functional>
#include <string>

namespace toile::files {

/// Runs `read` in a child process, so that a library that aborts, crashes, eats memory or never ends over a damaged
/// file takes the child down and not us. Returns what `read` returned there (its complaint, empty if it has none; an
/// exception's text counts). Throws Error naming `path` if the child did not come to an end by itself within
/// `cpu_seconds`. Internal to files/.
std::string trial_run(const std::string& path, int cpu_seconds, const std::function<std::string()>& read);

}  // namespace toile::files

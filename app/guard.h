#pragma once

#include <functional>
#include <string>

namespace toile::app {

/// Exit statuses of the contract.
enum ExitStatus { all_done = 0, our_failure = 1, input_at_fault = 2, some_samples_failed = 3 };

/// Runs `work` and turns every exception into one line on stderr, `toile: <what> (<where>)`, the mend below it, and the
/// exit status that goes with it.
int guarded(const std::function<int()>& work);

/// Prints the line and the mend.
void print_error(const std::string& what, const std::string& where, const std::string& mend);

}  // namespace toile::app

#pragma once

#include <chrono>
#include <string>

#include "generate/progress.h"

namespace toile::app {

/// From now on log lines go to stderr; stdout is for results.
void log_to_stderr();

/// Shows how far long work has come, on stderr: on a terminal one line, written over again, with the time left; else a
/// log line now and then.
class ProgressDisplay {
  public:
    ProgressDisplay();
    ~ProgressDisplay();
    void operator()(const generate::Progress& progress);
    void finish();  ///< ends the line

  private:
    void rewrite(const std::string& text);

    bool terminal_;
    bool line_open_ = false;
    std::string stage_;
    std::chrono::steady_clock::time_point stage_start_, last_shown_;
};

}  // namespace toile::app

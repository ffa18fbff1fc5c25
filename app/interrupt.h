#pragma once

#include <atomic>

namespace toile::app {

/// From now on the first interrupt (Ctrl-C, or a request to end) sets the flag, so that work can stop without leaving
/// half a file; a second one ends the program at once.
const std::atomic<bool>* watch_interrupt();

}  // namespace toile::app

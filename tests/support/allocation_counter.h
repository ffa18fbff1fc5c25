#pragma once

namespace toile {

/// Calls of operator new by this thread so far. The program that links allocation_counter.cpp has it count.
long allocation_count();

}  // namespace toile

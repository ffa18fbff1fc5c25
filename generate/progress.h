#pragma once

#include <functional>
#include <string_view>

namespace toile::generate {

/// How far a piece of long work has come.
struct Progress {
    std::string_view stage = {};  ///< "draping", "checking" ...
    int done = 0;
    int total = 0;   ///< 0 where it is one piece
    int failed = 0;  ///< samples that are not accepted
};

/// Called from one thread at a time.
using ProgressCallback = std::function<void(const Progress&)>;

}  // namespace toile::generate

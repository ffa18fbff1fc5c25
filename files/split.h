#pragma once

#include <array>

namespace toile::files {

/// Names of the splits by number, as `/samples/split` has them.
inline constexpr std::array<const char*, 3> split_name = {"train", "validation", "test"};

}  // namespace toile::files

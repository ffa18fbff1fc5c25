#pragma once

#include <cstdint>
#include <vector>

#include "generate/scene.h"

namespace toile::generate {

/// One pose's data, all but its image.
struct Sample {
    std::int64_t id = 0;
    skin::Pose pose;  ///< `[J x 3]`
    Positions cloth;  ///< `[V x 3]` r [m]
    pattern::EmbeddedCloth embedded;
    Positions displacement;  ///< `[V x 3]` (Δu, Δv, Δn) [m]
    simulate::Certificate certificate;
    simulate::DrapeStatus status = simulate::DrapeStatus::accepted;
    simulate::DrapeReport report;
    Positions draped;  ///< `[V x 3]` the cloth before rounding to single precision [m]
    std::vector<simulate::TryRecord> tries;
};

/// Skins, simulates and embeds pose `number`. Depends on the scene and the number alone; may run from several threads.
/// A drape that fails is in the status, with its cloth as it is.
Sample make_sample(const DressedScene& dressed, std::int64_t number);

}  // namespace toile::generate

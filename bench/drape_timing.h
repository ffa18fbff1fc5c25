#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulate/drape.h"
#include "skin/pose.h"

namespace toile::bench {

/// What a number of drapes took and came to.
struct DrapeTiming {
    int vertices = 0;
    double unit_milliseconds = 0;  ///< one factorisation on this mesh (cloth/factorisation_unit.h)
    std::vector<double> seconds;   ///< of each drape: processor time of the whole process
    std::vector<double> error;     ///< of each drape: root mean square distance from a reference [m]; empty without one
    std::map<std::string, double> stage;  ///< wall time of all drapes by stage [s]; "other" is the rest
    double iterations = 0;                ///< mean of a drape
    double accepted_share = 0;
    std::string refused;  ///< why nothing was timed, or empty

    double quantile_seconds(double share) const;
    double median_error() const;
    /// The median drape in factorisations.
    double units() const { return 1e3 * quantile_seconds(0.5) / unit_milliseconds; }
};

/// Drapes every pose from the neutral drape, one after the other; a scene without a body `repetitions` times from its
/// start. `reference`: where each drape ought to rest `[V x 3]`, one a pose, or none. `kept`: receives the drapes, if
/// asked for. A solver that cannot be had is a refusal.
DrapeTiming time_drapes(const simulate::DrapeScene& scene, const std::vector<skin::Pose>& poses, int repetitions = 1,
                        const std::vector<Positions>& reference = {}, std::vector<Positions>* kept = nullptr);

}  // namespace toile::bench

#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace toile::evaluate {

struct NamedDistances {
    std::string name;
    const std::vector<double>* distance;  ///< [m]
};

/// How often distances come in each of the bins from edge to edge: {"unit": "mm", "edges": [n + 1], "series": [{"name",
/// "counts": [n]}]}. Five bins a decade, from the decade of the smallest to that of the largest distance, at most from
/// 1e-4 to 1e4 mm; what lies beyond, and a distance of zero, is counted in the outermost bin. Without distances there
/// are no edges.
nlohmann::ordered_json noise_histogram(const std::vector<NamedDistances>& distances);

}  // namespace toile::evaluate

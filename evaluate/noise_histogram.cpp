#include "evaluate/noise_histogram.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

constexpr int bins_a_decade = 5, lowest_decade = -4, highest_decade = 4;  // of millimetres

double millimetre_decades(double distance) {
    return std::log10(std::max(1e3 * distance, 1e-300));
}

/// First and last decade of all distances; the same where there are none.
std::pair<int, int> decades(const std::vector<NamedDistances>& distances) {
    int low = highest_decade, high = lowest_decade;
    for (const NamedDistances& one : distances)
        for (const double distance : *one.distance) {
            const int decade = static_cast<int>(std::floor(millimetre_decades(distance)));
            low = std::min(low, decade);
            high = std::max(high, decade + 1);
        }
    if (high <= low) return {0, 0};
    return {std::clamp(low, lowest_decade, highest_decade - 1), std::clamp(high, lowest_decade + 1, highest_decade)};
}

}  // namespace

Json noise_histogram(const std::vector<NamedDistances>& distances) {
    const auto [low, high] = decades(distances);
    const int bins = bins_a_decade * (high - low);
    Json edges = Json::array(), series = Json::array();
    if (bins > 0)
        for (int k = 0; k <= bins; ++k) edges.push_back(std::pow(10.0, low + static_cast<double>(k) / bins_a_decade));
    for (const NamedDistances& one : distances) {
        if (bins == 0) break;
        std::vector<int> count(static_cast<size_t>(bins), 0);
        for (const double distance : *one.distance) {
            const double place = std::floor(bins_a_decade * (millimetre_decades(distance) - low));
            ++count[static_cast<size_t>(std::clamp(place, 0.0, bins - 1.0))];
        }
        series.push_back({{"name", one.name}, {"counts", count}});
    }
    return {{"unit", "mm"}, {"edges", edges}, {"series", series}};
}

}  // namespace toile::evaluate

#include "evaluate/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace toile::evaluate {

double gathered(Gather gather, std::span<const double> value) {
    if (value.empty()) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (const double one : value) sum += gather == Gather::mean ? one : one * one;
    sum /= static_cast<double>(value.size());
    return gather == Gather::mean ? sum : std::sqrt(sum);
}

Bootstrap::Bootstrap(int samples, std::uint64_t seed) : count_(draws, samples) {
    count_.setZero();
    std::mt19937_64 random(seed);
    // The remainder favours small numbers by less than one part in 2^50; distributions differ between libraries.
    for (int draw = 0; draw < draws; ++draw)
        for (int k = 0; k < samples; ++k)
            count_(draw, static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(samples))) += 1.0f;
}

Eigen::VectorXd Bootstrap::figures(Gather gather, std::span<const double> value) const {
    Eigen::VectorXd term(static_cast<Eigen::Index>(value.size()));
    for (Eigen::Index k = 0; k < term.size(); ++k) {
        const double one = value[static_cast<size_t>(k)];
        term[k] = gather == Gather::mean ? one : one * one;
    }
    // Row by row, so that the sum's order is fixed.
    Eigen::VectorXd figure(draws);
    for (int draw = 0; draw < draws; ++draw) {
        double sum = 0;
        for (Eigen::Index k = 0; k < term.size(); ++k) sum += static_cast<double>(count_(draw, k)) * term[k];
        sum /= static_cast<double>(term.size());
        figure[draw] = gather == Gather::mean ? sum : std::sqrt(sum);
    }
    return figure;
}

Interval interval_of(Eigen::VectorXd figures) {
    constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
    if (figures.size() == 0 || !figures.allFinite()) return {not_a_number, not_a_number};
    std::sort(figures.begin(), figures.end());
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(figures.size() - 1);
        const auto below = static_cast<Eigen::Index>(place);
        const Eigen::Index above = std::min(below + 1, figures.size() - 1);
        return figures[below] + (place - static_cast<double>(below)) * (figures[above] - figures[below]);
    };
    return {at(0.025), at(0.975)};
}

}  // namespace toile::evaluate

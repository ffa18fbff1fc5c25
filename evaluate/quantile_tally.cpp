#include "evaluate/quantile_tally.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace toile::evaluate {
namespace {

constexpr int bits_dropped = 52 - 12;  // of the 52 of the fraction

/// Rises with the value: the leading bits of its magnitude, negative for negative values.
std::int64_t class_of(double value) {
    const double magnitude = std::abs(value);
    std::int64_t bits = 0;
    std::memcpy(&bits, &magnitude, sizeof bits);
    const std::int64_t key = (bits >> bits_dropped) + 1;
    return value < 0 ? -key : key;
}

}  // namespace

QuantileTally::QuantileTally()
    : smallest_(std::numeric_limits<double>::quiet_NaN()), largest_(std::numeric_limits<double>::quiet_NaN()) {}

void QuantileTally::add(double value) {
    if (!std::isfinite(value)) {
        ++not_finite_;
        return;
    }
    Class& one = class_[class_of(value)];
    ++one.count;
    one.sum += value;
    sum_ += value;
    smallest_ = count_ == 0 ? value : std::min(smallest_, value);
    largest_ = count_ == 0 ? value : std::max(largest_, value);
    ++count_;
}

double QuantileTally::mean() const {
    return sum_ / static_cast<double>(count_);
}

double QuantileTally::quantile(double share) const {
    if (count_ == 0) return std::numeric_limits<double>::quiet_NaN();
    const double wanted = share * static_cast<double>(count_ - 1);
    std::int64_t below = 0;
    for (const auto& [key, one] : class_) {
        below += one.count;
        if (static_cast<double>(below) > wanted) return std::clamp(one.mean(), smallest_, largest_);
    }
    return largest_;
}

QuantileTally::Histogram QuantileTally::histogram(int bins) const {
    if (count_ == 0) return {};
    double low = quantile(0.001), high = quantile(0.999);
    const double least = 1e-6 * std::max(1.0, std::abs(low));  // of equal values, one bin holds all
    if (high - low < least) {
        low -= least / 2;
        high += least / 2;
    }
    Histogram out;
    const double width = (high - low) / bins;
    for (int k = 0; k <= bins; ++k) out.edges.push_back(low + k * width);
    out.counts.assign(static_cast<size_t>(bins), 0.0);
    for (const auto& [key, one] : class_) {
        const int bin = static_cast<int>(std::floor(std::clamp((one.mean() - low) / width, 0.0, bins - 1.0)));
        out.counts[bin] += static_cast<double>(one.count);
    }
    return out;
}

}  // namespace toile::evaluate

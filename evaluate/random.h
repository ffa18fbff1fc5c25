#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace toile::evaluate {

/// Random numbers from an explicit seed: the same ones on every machine with this C++ library.
class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// The stream of problem `number` of a run: does not depend on the problems before it.
    Random(std::uint64_t seed, std::uint64_t number) : engine_(mix(mix(seed) + number)) {}

    /// In [0, 1).
    double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
    double uniform(double lower, double upper) { return lower + (upper - lower) * unit(); }
    double log_uniform(double lower, double upper) { return lower * std::pow(upper / lower, unit()); }
    /// In [lower, upper].
    int integer(int lower, int upper) { return lower + static_cast<int>(unit() * (upper - lower + 1)); }
    bool chance(double probability) { return unit() < probability; }
    double normal() { return normal_(engine_); }

  private:
    /// The finaliser of SplitMix64: neighbouring seeds give unrelated streams.
    static std::uint64_t mix(std::uint64_t x) {
        x += 0x9e3779b97f4a7c15u;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
        return x ^ (x >> 31);
    }

    std::mt19937_64 engine_;
    std::normal_distribution<double> normal_;
};

}  // namespace toile::evaluate

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "generate/scene_config.h"
#include "skin/pose.h"

namespace toile::evaluate {

/// What is draped again: a configuration, and the poses of it.
struct NoiseSource {
    generate::SceneConfig config;
    struct Pose {
        std::int64_t id = 0;
        std::optional<skin::Pose> pose;  ///< none in a scene without poses: the neutral drape itself
    };
    std::vector<Pose> pose;  ///< all there are, in order of their id
};

/// The resolved configuration of a data set at `path`: the config.toml beside it where it is still the same, whose
/// paths are absolute, else the one that the file stores. Throws Error for what is wrong with it or with `overrides`.
generate::SceneConfig dataset_config(const files::DatasetHeader& header, const std::string& path,
                                     const std::vector<std::string>& overrides);

/// From a configuration, or from a data set: its samples' poses with its own resolved configuration. That is the
/// config.toml beside it where it is still the same, whose paths are absolute, else the one it stores. Throws Error for
/// what is wrong with either, and where the garment that the configuration gives today is not the data set's.
NoiseSource read_noise_source(const std::string& path, const std::vector<std::string>& overrides);

/// A share of the indices [0, count), at least one, ascending: the first of an order that the seed draws, so that a
/// larger share holds the smaller.
std::vector<int> drawn_share(int count, double share, std::uint64_t seed);

}  // namespace toile::evaluate

#include "evaluate/noise_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "generate/scene.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;

bool is_hdf5(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    return extension == ".h5" || extension == ".hdf5";
}

NoiseSource from_dataset(const std::string& path, const std::vector<std::string>& overrides) {
    const files::DatasetReader dataset(path);
    NoiseSource source;
    source.config = dataset_config(dataset.header(), path, overrides);
    for (int slot = 0; slot < dataset.sample_count(); ++slot) {
        const files::SampleRecord record = dataset.read(slot);
        source.pose.push_back({record.id, record.pose});
    }
    if (generate::build_scene(source.config).garment.mesh.triangle != dataset.header().mesh.triangle)
        throw Error("the garment of this data set's configuration is no longer the one it holds", path,
                    "generate the data set again with this version");
    return source;
}

NoiseSource from_config(const std::string& path, const std::vector<std::string>& overrides) {
    NoiseSource source;
    source.config = generate::read_scene(path, overrides);
    const generate::Scene scene = generate::build_posed_body(source.config);
    if (!scene.poses) source.pose.push_back({});
    for (const std::int64_t number : scene.pose_number) source.pose.push_back({number, scene.poses->pose(number)});
    return source;
}

}  // namespace

generate::SceneConfig dataset_config(const files::DatasetHeader& header, const std::string& path,
                                     const std::vector<std::string>& overrides) {
    const fs::path beside = fs::path(path).parent_path() / "config.toml";
    std::error_code ignored;
    if (fs::exists(beside, ignored)) {
        generate::SceneConfig config = generate::read_scene(beside.string(), {});
        if (config.hash == header.config_hash)
            return overrides.empty() ? config : generate::read_scene(beside.string(), overrides);
    }
    return generate::read_scene_text(header.config, path, overrides);
}

NoiseSource read_noise_source(const std::string& path, const std::vector<std::string>& overrides) {
    NoiseSource source = is_hdf5(path) ? from_dataset(path, overrides) : from_config(path, overrides);
    if (source.pose.empty()) throw Error("there is no pose to drape", path);
    std::sort(source.pose.begin(), source.pose.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return source;
}

std::vector<int> drawn_share(int count, double share, std::uint64_t seed) {
    std::vector<int> index(static_cast<size_t>(count));
    std::iota(index.begin(), index.end(), 0);
    std::mt19937_64 draw(seed);
    // std::shuffle differs between libraries; this does not.
    for (int k = count - 1; k > 0; --k) std::swap(index[k], index[draw() % static_cast<std::uint64_t>(k + 1)]);
    const int wanted = std::clamp(static_cast<int>(std::ceil(share * count - 1e-9)), 1, count);
    index.resize(static_cast<size_t>(wanted));
    std::sort(index.begin(), index.end());
    return index;
}

}  // namespace toile::evaluate

#include "skin/pose_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "cloth/error.h"
#include "skin/pose_cluster.h"

namespace toile::skin {
namespace {

struct Cluster {
    std::int64_t size = 0;
    std::int64_t name = 0;   ///< the smallest pose number in it
    std::uint64_t hash = 0;  ///< of seed and name: its place in the queue
    Split split = Split::train;
};

/// SplitMix64 (Steele et al. 2014): a permutation of the 64-bit words that mixes every bit.
std::uint64_t mixed(std::uint64_t word) {
    word += 0x9E3779B97F4A7C15u;
    word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    return word ^ (word >> 31);
}

void check_options(const SplitOptions& options) {
    const auto check = [](const char* name, double value, double most) {
        if (!(value >= 0 && value <= most))
            throw Error(std::string(name) + " is " + std::to_string(value) + ", but should be from 0 to " +
                        std::to_string(most));
    };
    check("validation_share", options.validation_share, 1);
    check("test_share", options.test_share, 1);
    check("validation_share + test_share", options.validation_share + options.test_share, 1 + 1e-12);
    check("duplicate_angle", options.duplicate_angle, M_PI);
}

/// Clusters in the order of their hashes.
std::vector<Cluster> queue(const std::vector<int>& label, const std::vector<std::int64_t>& number, std::uint64_t seed) {
    std::map<int, Cluster> by_label;
    for (std::size_t k = 0; k < label.size(); ++k) {
        Cluster& cluster = by_label[label[k]];
        cluster.name = cluster.size == 0 ? number[k] : std::min(cluster.name, number[k]);
        ++cluster.size;
    }
    std::vector<Cluster> cluster;
    for (auto& entry : by_label) {
        entry.second.hash = mixed(mixed(seed) ^ static_cast<std::uint64_t>(entry.second.name));
        cluster.push_back(entry.second);
    }
    std::sort(cluster.begin(), cluster.end(), [](const Cluster& a, const Cluster& b) { return a.hash < b.hash; });
    return cluster;
}

/// Moves clusters from train to `split` while that brings its size nearer to `wanted`: first, in the order of the
/// queue, those that fit; then the one that comes nearest to what is missing.
void fill(std::vector<Cluster>& cluster, Split split, double wanted) {
    double missing = wanted;
    for (Cluster& c : cluster)
        if (c.split == Split::train && static_cast<double>(c.size) <= missing + 1e-9) {
            c.split = split;
            missing -= static_cast<double>(c.size);
        }
    Cluster* best = nullptr;
    double error = missing;
    for (Cluster& c : cluster)
        if (c.split == Split::train && std::abs(static_cast<double>(c.size) - missing) < error) {
            best = &c;
            error = std::abs(static_cast<double>(c.size) - missing);
        }
    if (best) best->split = split;
}

/// Gives an empty split the smallest cluster of a split that has more than one.
void ensure_one(std::vector<Cluster>& cluster, Split split) {
    std::array<int, 3> clusters = {0, 0, 0};
    for (const Cluster& c : cluster) ++clusters[static_cast<int>(c.split)];
    if (clusters[static_cast<int>(split)] > 0) return;
    Cluster* smallest = nullptr;
    for (Cluster& c : cluster)
        if (clusters[static_cast<int>(c.split)] > 1 && (!smallest || c.size < smallest->size)) smallest = &c;
    if (smallest) smallest->split = split;
}

/// Fewer clusters than splits: the largest is for training, the next for testing.
void assign_few(std::vector<Cluster>& cluster, const std::vector<Split>& wanted) {
    std::vector<Cluster*> by_size;
    for (Cluster& c : cluster) by_size.push_back(&c);
    std::stable_sort(by_size.begin(), by_size.end(),
                     [](const Cluster* a, const Cluster* b) { return a->size > b->size; });
    for (std::size_t i = 0; i < by_size.size(); ++i) by_size[i]->split = wanted[i];
}

/// Meets the shares as well as whole clusters can, with no split left empty that has a positive share.
void assign(std::vector<Cluster>& cluster, double poses, const SplitOptions& options) {
    std::vector<Split> wanted;
    if (1 - options.validation_share - options.test_share > 1e-9) wanted.push_back(Split::train);
    if (options.test_share > 0) wanted.push_back(Split::test);
    if (options.validation_share > 0) wanted.push_back(Split::validation);
    if (cluster.size() < wanted.size()) return assign_few(cluster, wanted);
    fill(cluster, Split::test, options.test_share * poses);
    fill(cluster, Split::validation, options.validation_share * poses);
    for (const Split split : wanted) ensure_one(cluster, split);
}

}  // namespace

PoseSplits split_poses(const std::vector<Pose>& pose, const std::vector<std::int64_t>& number,
                       const SplitOptions& options) {
    check_options(options);
    if (number.size() != pose.size()) throw Error("there are more pose numbers than poses, or fewer");
    const std::vector<int> label = cluster_poses(pose, options.duplicate_angle);
    std::vector<Cluster> cluster = queue(label, number, options.seed);
    assign(cluster, static_cast<double>(pose.size()), options);

    PoseSplits splits;
    splits.clusters = static_cast<int>(cluster.size());
    std::map<std::int64_t, Split> by_name;
    for (const Cluster& c : cluster) {
        by_name[c.name] = c.split;
        splits.largest_cluster = std::max(splits.largest_cluster, static_cast<int>(c.size));
    }
    std::map<int, std::int64_t> name;
    for (std::size_t k = 0; k < pose.size(); ++k) {
        const auto [entry, first] = name.emplace(label[k], number[k]);
        if (!first) entry->second = std::min(entry->second, number[k]);
    }
    for (const int l : label) splits.split.push_back(by_name.at(name.at(l)));
    return splits;
}

}  // namespace toile::skin

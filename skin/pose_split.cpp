#include "skin/pose_split.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cloth/error.h"

namespace toile::skin {
namespace {

constexpr int largest_block = 4096;
constexpr const char* split_name[3] = {"train", "validation", "test"};

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

/// So many evenly spaced places that the smallest share cannot fall between two of them.
int places_for(const SplitOptions& options) {
    double smallest = 1;
    for (const double share :
         {options.validation_share, options.test_share, 1 - options.validation_share - options.test_share})
        if (share > 1e-9) smallest = std::min(smallest, share);
    return static_cast<int>(std::min<double>(std::ceil(1 / smallest - 1e-9), largest_block));
}

}  // namespace

SplitSequence::SplitSequence(const SplitOptions& options) : options_(options) {
    check_options(options);
    block_size_ = places_for(options);
}

Split SplitSequence::at(double place) const {
    if (place >= 1 - options_.test_share) return Split::test;
    return place >= 1 - options_.test_share - options_.validation_share ? Split::validation : Split::train;
}

void SplitSequence::deal(std::int64_t block) {
    // Offsets of successive blocks follow the golden ratio, so that shares no block can meet alone are met by many.
    const std::uint64_t turn = mixed(options_.seed) + static_cast<std::uint64_t>(block) * 0x9E3779B97F4A7C15u;
    const double offset = static_cast<double>(turn >> 11) * 0x1p-53;
    std::vector<std::pair<std::uint64_t, int>> card(block_size_);
    const std::uint64_t key = mixed(mixed(options_.seed + 1) ^ static_cast<std::uint64_t>(block));
    for (int i = 0; i < block_size_; ++i) card[i] = {mixed(key + static_cast<std::uint64_t>(i)), i};
    std::sort(card.begin(), card.end());
    split_.resize(block_size_);
    for (int i = 0; i < block_size_; ++i) split_[i] = at((card[i].second + offset) / block_size_);
    if (block == 0) {
        const auto trains = std::find(split_.begin(), split_.end(), Split::train);
        if (trains != split_.end()) std::iter_swap(split_.begin(), trains);
    }
    dealt_ = block;
}

Split SplitSequence::operator()(std::int64_t group) {
    const std::int64_t block = group / block_size_;
    if (block != dealt_) deal(block);
    return split_[static_cast<std::size_t>(group % block_size_)];
}

std::vector<std::string> split_remarks(const PoseSplits& splits, const SplitOptions& options) {
    const double share[3] = {1 - options.validation_share - options.test_share, options.validation_share,
                             options.test_share};
    std::string empty;
    for (int s = 0; s < 3; ++s)
        if (share[s] > 1e-9 && splits.size[s] == 0) empty += std::string(empty.empty() ? "" : " and ") + split_name[s];
    std::vector<std::string> remarks;
    if (!empty.empty())
        remarks.push_back("no sample is for " + empty + ": the poses make " + std::to_string(splits.groups) +
                          (splits.groups == 1 ? " group" : " groups") + " of near-duplicates, the largest of " +
                          std::to_string(splits.largest) + " (split.duplicate_angle)");
    if (splits.conflicts > 0)
        remarks.push_back(std::to_string(splits.conflicts) + " poses, the first number " +
                          std::to_string(splits.first) +
                          ", are nearly those of samples in another split: they lie closer to each other than "
                          "split.duplicate_angle can keep apart");
    return remarks;
}

}  // namespace toile::skin

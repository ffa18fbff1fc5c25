#include "skin/pose_source.h"

#include <algorithm>
#include <numeric>

#include "cloth/error.h"
#include "skin/pose_cluster.h"
#include "skin/pose_group.h"

namespace toile::skin {
namespace {

void check_number(std::int64_t number, std::int64_t count, const std::string& where = {}) {
    if (number < 0 || number >= count)
        throw Error("there is no pose number " + std::to_string(number) + ": there are " + std::to_string(count) +
                        " poses, counted from 0",
                    where);
}

constexpr std::int64_t small_group = 8;  // poses of a group that may go to any split

void add(PoseSplits& splits, Split split) {
    splits.split.push_back(split);
    ++splits.size[static_cast<int>(split)];
}

}  // namespace

PoseSplits PoseSource::splits(const SplitOptions& options) const {
    return splits(selected_numbers(*this, {}), options);
}

PoseSplits PoseList::splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const {
    for (const std::int64_t k : number) check_number(k, count());
    SplitSequence sequence(options);
    const std::vector<int> first = cluster_poses(pose_, options.duplicate_angle);
    std::vector<std::int64_t> founded(pose_.size()), size(pose_.size(), 0);
    PoseGroups groups([this](std::int64_t k) { return pose_[static_cast<std::size_t>(k)]; }, count(),
                      options.duplicate_angle);
    for (std::size_t k = 0; k < pose_.size(); ++k) {
        founded[k] = groups.next().group;
        ++size[first[k]];
    }
    // What would be a flood rather than a share of the source trains.
    const auto split_of = [&](int leader) {
        const Split split = sequence(founded[leader]);
        const double share = split == Split::test ? options.test_share : options.validation_share;
        const bool flood = size[leader] > small_group && static_cast<double>(size[leader]) > share * count();
        return flood && options.test_share + options.validation_share < 1 ? Split::train : split;
    };
    PoseSplits splits;
    std::vector<bool> seen(pose_.size(), false);
    for (const std::int64_t k : number) {
        const int leader = first[static_cast<std::size_t>(k)];
        if (!seen[leader]) ++splits.groups;
        seen[leader] = true;
        splits.largest = std::max(splits.largest, size[leader]);
        add(splits, split_of(leader));
    }
    return splits;
}

Pose PoseList::pose(std::int64_t number) const {
    check_number(number, count());
    return pose_[static_cast<std::size_t>(number)];
}

SampledPoses::SampledPoses(PoseSampler sampler, std::int64_t count) : sampler_(std::move(sampler)), count_(count) {
    if (count < 1) throw Error("the number of poses is " + std::to_string(count) + ", but should be 1 or more");
}

Pose SampledPoses::pose(std::int64_t number) const {
    check_number(number, count_);
    return sampler_.pose(number);
}

PoseSplits SampledPoses::splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const {
    std::int64_t last = -1;
    for (const std::int64_t k : number) {
        check_number(k, count_);
        last = std::max(last, k);
    }
    SplitSequence sequence(options);
    PoseGroups groups([this](std::int64_t k) { return sampler_.pose(k); }, last + 1, options.duplicate_angle);
    std::vector<std::int32_t> size;  // of each group
    std::vector<Split> split_of;     // of each group
    std::vector<Split> split;        // of each pose
    std::vector<bool> conflict;
    for (std::int64_t k = 0; k <= last; ++k) {
        const PoseGroups::Place place = groups.next();
        if (place.founds) {
            size.push_back(0);
            split_of.push_back(sequence(place.group));
        }
        ++size[static_cast<std::size_t>(place.group)];
        split.push_back(split_of[static_cast<std::size_t>(place.group)]);
        conflict.push_back(std::any_of(place.near.begin(), place.near.end(), [&](std::int64_t g) {
            return split_of[static_cast<std::size_t>(g)] != split.back();
        }));
    }
    PoseSplits splits;
    splits.groups = static_cast<std::int64_t>(size.size());
    for (const std::int32_t one : size) splits.largest = std::max<std::int64_t>(splits.largest, one);
    for (const std::int64_t k : number) {
        add(splits, split[static_cast<std::size_t>(k)]);
        if (!conflict[static_cast<std::size_t>(k)]) continue;
        splits.first = splits.conflicts++ == 0 ? k : std::min(splits.first, k);
    }
    return splits;
}

std::vector<std::int64_t> selected_numbers(const PoseSource& source, const PoseSelection& selection,
                                           const std::string& where) {
    std::vector<std::int64_t> number = selection.number;
    if (number.empty()) {
        number.resize(static_cast<std::size_t>(source.count()));
        std::iota(number.begin(), number.end(), 0);
    }
    std::vector<bool> seen(static_cast<std::size_t>(source.count()), false);
    for (const std::int64_t k : number) {
        check_number(k, source.count(), where);
        if (seen[static_cast<std::size_t>(k)])
            throw Error("pose number " + std::to_string(k) + " is listed twice", where);
        seen[static_cast<std::size_t>(k)] = true;
    }
    if (!selection.most) return number;
    if (*selection.most < 1)
        throw Error("the number of poses is " + std::to_string(*selection.most) + ", but should be 1 or more", where);
    if (*selection.most < static_cast<std::int64_t>(number.size()))
        number.resize(static_cast<std::size_t>(*selection.most));
    return number;
}

}  // namespace toile::skin

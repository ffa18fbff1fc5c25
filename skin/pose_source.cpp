#include "skin/pose_source.h"

#include <numeric>
#include <set>

#include "cloth/error.h"

namespace toile::skin {
namespace {

void check_number(std::int64_t number, std::int64_t count, const std::string& where = {}) {
    if (number < 0 || number >= count)
        throw Error("there is no pose number " + std::to_string(number) + ": there are " + std::to_string(count) +
                        " poses, counted from 0",
                    where);
}

}  // namespace

PoseSplits PoseSource::splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const {
    std::vector<Pose> wanted;
    wanted.reserve(number.size());
    for (const std::int64_t k : number) wanted.push_back(pose(k));
    return split_poses(wanted, number, options);
}

PoseSplits PoseSource::splits(const SplitOptions& options) const {
    return splits(selected_numbers(*this, {}), options);
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

std::vector<std::int64_t> selected_numbers(const PoseSource& source, const PoseSelection& selection,
                                           const std::string& where) {
    std::vector<std::int64_t> number = selection.number;
    if (number.empty()) {
        number.resize(static_cast<std::size_t>(source.count()));
        std::iota(number.begin(), number.end(), 0);
    }
    std::set<std::int64_t> seen;
    for (const std::int64_t k : number) {
        check_number(k, source.count(), where);
        if (!seen.insert(k).second) throw Error("pose number " + std::to_string(k) + " is listed twice", where);
    }
    if (!selection.most) return number;
    if (*selection.most < 1)
        throw Error("the number of poses is " + std::to_string(*selection.most) + ", but should be 1 or more", where);
    if (*selection.most < static_cast<std::int64_t>(number.size()))
        number.resize(static_cast<std::size_t>(*selection.most));
    return number;
}

}  // namespace toile::skin

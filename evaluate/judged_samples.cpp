#include "evaluate/judged_samples.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "evaluate/accuracy_figures.h"
#include "evaluate/noise_source.h"
#include "generate/stored_body.h"

namespace toile::evaluate {
namespace {

JudgedSplit choose_of(int split, const std::vector<int>& splits, const std::vector<int>& status, int most,
                      std::uint64_t seed) {
    JudgedSplit chosen;
    chosen.split = split;
    std::vector<int> accepted;
    for (size_t slot = 0; slot < splits.size(); ++slot) {
        chosen.there += splits[slot] == split;
        if (splits[slot] == split && status[slot] == 0) accepted.push_back(static_cast<int>(slot));
    }
    chosen.accepted = static_cast<int>(accepted.size());
    if (accepted.empty() || most <= 0 || most >= chosen.accepted) {
        chosen.slot = std::move(accepted);
        return chosen;
    }
    for (const int k : drawn_share(chosen.accepted, static_cast<double>(most) / chosen.accepted, seed))
        chosen.slot.push_back(accepted[static_cast<size_t>(k)]);
    return chosen;
}

}  // namespace

std::vector<JudgedSplit> choose_samples(const files::DatasetReader& dataset, const std::vector<int>& splits, int most) {
    const std::string& path = dataset.file().path();
    if (dataset.sample_count() == 0) throw Error("the data set is empty", path + ":/samples");
    const auto split = dataset.file().read<int>("/samples/split", {dataset.sample_count()}).value;
    const auto status = dataset.file().read<int>("/samples/status", {dataset.sample_count()}).value;
    if (std::find(status.begin(), status.end(), 0) == status.end())
        throw Error("the data set has no accepted sample: there is no truth to hold predictions against",
                    path + ":/samples/status", "toile validate says what became of its samples");
    std::vector<JudgedSplit> all;
    for (int one = 0; one < 3; ++one) {
        const bool asked = std::find(splits.begin(), splits.end(), one) != splits.end();
        if (!splits.empty() && !asked) continue;
        JudgedSplit chosen = choose_of(one, split, status, most, static_cast<std::uint64_t>(dataset.header().seed));
        if (asked && chosen.accepted == 0)
            throw Error(std::string("the data set has no accepted sample in the split ") + split_name(one),
                        path + ":/samples/split", "leave out --split " + std::string(split_name(one)));
        if (chosen.accepted > 0) all.push_back(std::move(chosen));
    }
    if (all.empty()) throw Error("no accepted sample is in the split 0, 1 or 2", path + ":/samples/split");
    return all;
}

TrueSamples::TrueSamples(const files::DatasetReader& dataset, const ClothJudge& judge)
    : dataset_(dataset), judge_(judge) {
    if (dataset.header().body && dataset.header().embedding) body_ = generate::skinned_body(*dataset.header().body);
}

int TrueSamples::block_size(int jobs) const {
    // A cloth's positions a few dozen times, and the body's search tree with its normals.
    const double triangles = body_ ? static_cast<double>(body_->triangle.rows()) : 0.0;
    const double sample = 1500.0 * judge_.mesh().vertex_count() + 600.0 * triangles;
    return static_cast<int>(std::clamp(512e6 / sample, 8.0, 8.0 * std::clamp(jobs, 2, 8)));
}

void TrueSamples::prepare(TrueSample& sample) const {
    std::shared_ptr<const skin::SurfaceQuery> query;
    if (body_) {
        sample.body = generate::posed_as_stored(dataset_.header(), *body_, sample.record).position;
        query = std::make_shared<const skin::SurfaceQuery>(body_->triangle, sample.body);
    }
    sample.target = judge_.target(sample.record.cloth, std::move(query));
}

std::vector<TrueSample> TrueSamples::read(std::span<const int> slot, int jobs) const {
    std::vector<TrueSample> samples(slot.size());
    for (size_t k = 0; k < slot.size(); ++k) {
        files::SampleRecord& record = samples[k].record;
        record = dataset_.read(slot[k]);
        const bool finite = record.cloth.allFinite() && record.pose.allFinite() && record.embedded.allFinite();
        if (!finite)
            throw Error("sample " + std::to_string(record.id) + " is accepted, but not finite",
                        dataset_.file().path() + ":/samples/cloth", "toile validate lists what is wrong with it");
    }
    parallel_for(static_cast<int>(slot.size()), jobs, [&](int, int k) { prepare(samples[static_cast<size_t>(k)]); });
    return samples;
}

}  // namespace toile::evaluate

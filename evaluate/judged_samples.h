#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluate/cloth_quantities.h"
#include "files/dataset_file.h"
#include "skin/body.h"

namespace toile::evaluate {

/// What is judged of a split.
struct JudgedSplit {
    int split = 0;          ///< 0 train, 1 validation, 2 test
    int there = 0;          ///< samples of the split
    int accepted = 0;       ///< of them; the others are not judged
    std::vector<int> slot;  ///< `[n]` drawn of the accepted ones, ascending
};

/// Draws at most `most` (0: all) of the accepted samples of each split, by the data set's seed; a larger draw holds the
/// smaller. Without `splits`, of those that have any. Throws Error for a data set without samples, without accepted
/// samples, or without any of a split that is asked for.
std::vector<JudgedSplit> choose_samples(const files::DatasetReader& dataset, const std::vector<int>& splits, int most);

/// A sample as it is judged.
struct TrueSample {
    files::SampleRecord record;
    JudgedTarget target;
    Positions body;  ///< `[Vb x 3]` in its pose [m]; empty without a body
};

/// Reads samples with their bodies in pose.
class TrueSamples {
  public:
    TrueSamples(const files::DatasetReader& dataset, const ClothJudge& judge);

    /// The samples at `slot`, prepared by `jobs` threads; a body's structures are made once for all cloths on it.
    /// Throws Error for an accepted sample that is not finite.
    std::vector<TrueSample> read(std::span<const int> slot, int jobs) const;
    bool has_body() const { return body_.has_value(); }
    /// Samples that are well in memory together, on a mesh and a body of this size.
    int block_size(int jobs) const;

  private:
    void prepare(TrueSample& sample) const;

    const files::DatasetReader& dataset_;
    const ClothJudge& judge_;
    std::optional<skin::Body> body_;
};

}  // namespace toile::evaluate

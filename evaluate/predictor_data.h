#pragma once

#include <cstdint>
#include <vector>

#include "files/dataset_file.h"
#include "pattern/embedding.h"
#include "skin/pose.h"

namespace toile::evaluate {

/// What a predictor may look at of a sample: never its cloth.
struct PredictorInput {
    std::int64_t id = 0;
    skin::Pose pose;           ///< `[J x 3]` axis-angle [rad]
    std::vector<float> image;  ///< `[C x H x W]` [m]; for predictors that ask for it
};

/// A data set as predictors see it: its accepted samples, read one at a time and only as far as they are wanted. The
/// reader must outlive it.
class PredictorData {
  public:
    /// Throws Error for a data set that nothing can be predicted of: empty, without an accepted sample, or without an
    /// embedding, which carries the displacement that is predicted.
    explicit PredictorData(const files::DatasetReader& dataset);

    const files::DatasetReader& dataset() const { return *dataset_; }
    int vertex_count() const { return dataset_->header().mesh.vertex_count(); }
    int joint_count() const { return static_cast<int>(dataset_->header().body->joint_name.size()); }
    const std::vector<int>& accepted() const { return accepted_; }  ///< slots, ascending
    const std::vector<int>& train() const { return train_; }        ///< slots of those in the train split; may be none
    std::int64_t id(int slot) const { return id_[static_cast<size_t>(slot)]; }
    int split(int slot) const { return split_[static_cast<size_t>(slot)]; }  ///< 0 train, 1 validation, 2 test

    // Arrays of an accepted sample. Error naming it where a number is not finite, or the shape is wrong.
    PredictorInput input(int slot, bool with_image) const;
    Positions displacement(int slot) const;  ///< `[V x 3]` (Δu, Δv, Δn) [m]
    pattern::EmbeddedCloth embedded(int slot) const;
    Positions cloth(int slot) const;  ///< `[V x 3]` r_T [m]

  private:
    std::vector<float> values(const char* name, int slot, const files::Shape& row) const;
    Positions positions(const char* name, int slot) const;

    const files::DatasetReader* dataset_;
    std::vector<std::int64_t> id_;
    std::vector<int> split_, accepted_, train_;
};

}  // namespace toile::evaluate

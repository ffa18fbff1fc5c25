#pragma once

#include <memory>
#include <vector>

#include "skin/body.h"
#include "skin/pose.h"
#include "skin/pose_source.h"
#include "skin/skinning.h"

namespace toile::skin {

/// Keeps arms off the trunk. A motion recorded from one person and played by a body of another build presses its arms
/// into its ribs by some millimetres, where a garment has no room to be.
///
/// Arm vertices are to keep `gap` [m] from the trunk, or a seventh of what they stand off it in the bind pose where
/// that is less: towards the armpit the gap closes in every pose. An arm that does not is turned about its shoulder,
/// away from the places where it is too near, by steps of a few degrees until it does. One that would have to be turned
/// by more than `largest_turn` (a hand through the chest) keeps its pose. The other joints keep theirs.
class ArmClearance {
  public:
    /// Bodies without an upper arm have nothing to be turned. `body` must outlive the object.
    ArmClearance(const Body& body, SkinningMethod method, double gap);

    Pose clear(const Pose& pose) const;

    static constexpr double largest_turn = 0.4;  ///< [rad]

  private:
    struct Kept {
        int vertex;
        double gap;  ///< from the trunk, at least [m]
    };
    struct Arm {
        int joint;
        std::vector<Kept> kept;
    };
    bool turn_away(const Arm& arm, Pose& pose) const;

    const Body& body_;
    SkinningMethod method_;
    Triangles trunk_;
    std::vector<bool> rim_;  ///< its triangles beside a cut
    std::vector<Arm> arm_;
};

/// The poses of another source, their arms kept off the trunk. Number k is the other's number k.
class ClearedPoses : public PoseSource {
  public:
    /// Copies the body.
    ClearedPoses(std::unique_ptr<PoseSource> source, const Body& body, SkinningMethod method, double gap);
    std::int64_t count() const override { return source_->count(); }
    Pose pose(std::int64_t number) const override { return clearance_.clear(source_->pose(number)); }
    using PoseSource::splits;
    /// Those of the source's own poses: turning arms takes some milliseconds a pose.
    PoseSplits splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const override {
        return source_->splits(number, options);
    }

  private:
    std::unique_ptr<PoseSource> source_;
    Body body_;
    ArmClearance clearance_;
};

}  // namespace toile::skin

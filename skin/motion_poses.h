#pragma once

#include <string>
#include <vector>

#include "files/motion_file.h"
#include "skin/body.h"
#include "skin/motion_fit.h"
#include "skin/pose_source.h"

namespace toile::skin {

struct MotionOptions : MotionFitOptions {
    int first_frame = 0;
    int last_frame = -1;  ///< -1: the motion's last
    int stride = 1;       ///< every so many frames; 1 or more
    double rate = 0;      ///< poses a second, interpolated on the sphere of rotations [1/s]; 0: the motion's own frames
};

/// The body following the motion, seen from the motion's pelvis: the root keeps its place and bearing, whichever way
/// the person walks or turns. Joints without a counterpart keep the bind pose relative to their parent. Left stays
/// left. Throws Error at `where` for a frame range outside the motion, a stride below 1, a rate that is negative, not
/// finite, given along with a stride or to a motion without a frame time; and what `fit_motion` refuses.
std::vector<Pose> motion_poses(const Body& body, const files::Motion& motion, const MotionFit& fit,
                               const MotionOptions& options, const std::string& where);

struct MotionPoses {
    PoseList poses;
    MotionFit fit;
};

/// Reads a BVH file (`files::read_motion`) and poses the body after it. Where the file's rest pose is no standing
/// person, a frame takes its place (`standing_frame`).
MotionPoses read_motion_poses(const Body& body, const std::string& path, const MotionOptions& options = {});

}  // namespace toile::skin

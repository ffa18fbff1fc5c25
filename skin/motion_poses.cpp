#include "skin/motion_poses.h"

#include <cmath>
#include <optional>

#include "cloth/error.h"
#include "skin/motion_rest.h"

namespace toile::skin {
namespace {

using Rotations = std::vector<Eigen::Quaterniond>;

/// Frames of the motion to take, whole or between two.
std::vector<double> frame_times(const files::Motion& motion, const MotionOptions& options, const std::string& where) {
    const int last = options.last_frame == -1 ? motion.frame_count - 1 : options.last_frame;
    if (options.first_frame < 0 || options.first_frame > last || last >= motion.frame_count)
        throw Error("the frames " + std::to_string(options.first_frame) + " to " + std::to_string(last) +
                        " are not a range of the motion's " + std::to_string(motion.frame_count) + " frames",
                    where, "frames are counted from 0; last_frame = -1 is the motion's last");
    if (options.stride < 1)
        throw Error("the stride is " + std::to_string(options.stride) + ", but should be 1 or more", where);
    if (!std::isfinite(options.rate) || options.rate < 0)
        throw Error("the rate is " + std::to_string(options.rate) + ", but should be positive, or 0 for every frame",
                    where);
    double step = options.stride;
    if (options.rate > 0) {
        if (options.stride != 1) throw Error("stride and rate are both given", where, "give one of them");
        if (!(motion.frame_time > 0)) throw Error("a rate is given, but the motion has no frame time", where);
        step = 1 / (options.rate * motion.frame_time);
        if ((last - options.first_frame) / step > 1e7)
            throw Error("the rate of " + std::to_string(options.rate) + " poses a second gives too many poses", where);
    }
    std::vector<double> time;
    // A last frame missed by rounding is still taken.
    for (int k = 0; options.first_frame + k * step <= last + 1e-6; ++k)
        time.push_back(std::min<double>(options.first_frame + k * step, last));
    return time;
}

/// The joints' rotations relative to rest, in the motion's axes, at a frame or between two.
Rotations global_rotations(const files::Motion& motion, double time) {
    const int frame = static_cast<int>(time);
    const double share = time - frame;
    Rotations global(static_cast<std::size_t>(motion.joint_count()));
    for (int j = 0; j < motion.joint_count(); ++j) {
        Eigen::Quaterniond local = motion.local_rotation(frame, j);
        // slerp takes the shorter way, whatever the quaternions' signs and however the Euler angles have wrapped.
        if (share > 0) local = local.slerp(share, motion.local_rotation(frame + 1, j));
        const int parent = motion.joint_parent[j];
        global[j] = parent < 0 ? local : (global[parent] * local).normalized();
    }
    return global;
}

Pose pose_after(const Body& body, const std::vector<const MotionFit::Link*>& link_of_joint, const MotionFit& fit,
                const Rotations& global) {
    Pose pose = Pose::Zero(body.joint_count(), 3);
    std::vector<Eigen::Matrix3d> turned(body.joint.size());  // relative to bind, in the body's axes
    for (int j = 0; j < body.joint_count(); ++j) {
        const int parent = body.joint[j].parent;
        const Eigen::Matrix3d carried = parent < 0 ? Eigen::Matrix3d::Identity().eval() : turned[parent];
        turned[j] = carried;
        if (const MotionFit::Link* link = link_of_joint[j]) {
            const Eigen::Matrix3d from_pelvis =
                (global[fit.pelvis].conjugate() * global[link->source]).toRotationMatrix();
            turned[j] = fit.axes * from_pelvis * fit.axes.transpose() * link->align;
            const Eigen::Matrix3d bind = body.joint[j].bind.topLeftCorner<3, 3>();
            const Eigen::Matrix3d local = bind.transpose() * carried.transpose() * turned[j] * bind;
            const Eigen::AngleAxisd rotation(Eigen::Quaterniond(local).normalized());
            pose.row(j) = (rotation.angle() * rotation.axis()).transpose();
        }
    }
    return pose;
}

}  // namespace

std::vector<Pose> motion_poses(const Body& body, const files::Motion& motion, const MotionFit& fit,
                               const MotionOptions& options, const std::string& where) {
    std::vector<const MotionFit::Link*> link_of_joint(body.joint.size(), nullptr);
    for (const MotionFit::Link& link : fit.link) link_of_joint[link.body_joint] = &link;
    std::vector<Pose> pose;
    for (const double time : frame_times(motion, options, where))
        pose.push_back(pose_after(body, link_of_joint, fit, global_rotations(motion, time)));
    return pose;
}

MotionPoses read_motion_poses(const Body& body, const std::string& path, const MotionOptions& options) {
    files::Motion motion = files::read_motion(path);
    const std::optional<int> standing = standing_frame(motion, motion_roles(motion, options, path));
    if (standing) motion = with_rest_frame(motion, *standing);
    MotionFit fit = fit_motion(body, motion, options, path);
    if (standing)
        fit.remarks.push_back("the file's rest pose is no standing person: frame " + std::to_string(*standing) +
                              " is taken for it");
    return {PoseList(motion_poses(body, motion, fit, options, path)), std::move(fit)};
}

}  // namespace toile::skin

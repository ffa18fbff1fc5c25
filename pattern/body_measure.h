#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "cloth/types.h"
#include "pattern/body_section.h"
#include "skin/body.h"

namespace toile::pattern {

/// One arm as a sleeve meets it. Side 0 is the body's left (+x), side 1 its right.
struct ArmMeasure {
    Eigen::Vector3d shoulder, elbow, wrist;  ///< joints [m]
    Eigen::Vector3d notch;                   ///< apex of the notch between arm and trunk [m]
    Eigen::Vector3d notch_direction;         ///< unit, out of the notch
    double circumference = 0.0;              ///< largest of the upper arm's middle half [m]
    std::vector<double> station;             ///< distances along shoulder - elbow - wrist [m]
    std::vector<Eigen::Vector3d> center;     ///< of the section at each station [m]
    std::vector<double> tape;                ///< circumference at each station [m]
};

/// Parts of the body's surface by skin weight, in the neutral pose.
struct BodyParts {
    Triangles trunk;               ///< all but arms and head
    std::array<Triangles, 2> arm;  ///< from the shoulder joint down
    Triangles below_head;          ///< all but the head
};

/// A tailor's measurements of a body in its neutral pose (arms in an A or a T pose). Circumferences are convex, as a
/// tape lies.
struct BodyMeasure {
    BodyParts part;
    double center_x = 0.0, center_z = 0.0;  ///< the vertical axis of the trunk [m]
    double underarm_height = 0.0;           ///< of the lower of the two notches [m]
    double hip_height = 0.0;                ///< of the hip joints [m]
    double neck_height = 0.0;               ///< of the neck joint [m]
    double neck_half_width = 0.0;           ///< [m]
    double shoulder_half_width = 0.0;       ///< from the axis to a shoulder joint [m]
    double chest = 0.0;                     ///< largest circumference in the chest below the arms [m]
    std::array<ArmMeasure, 2> arm;
};

/// Needs the roles pelvis, neck, both upper and both lower arms. Throws Error that names what is missing or cannot be
/// measured.
BodyMeasure measure_body(const skin::Body& body);

/// The trunk's section at `height` [m] as points (x, z); empty where there is none.
std::vector<Eigen::Vector2d> trunk_section(const skin::Body& body, const BodyParts& part, double height);

}  // namespace toile::pattern

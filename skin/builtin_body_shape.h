#pragma once

#include <Eigen/Core>
#include <vector>

#include "skin/implicit_column.h"

namespace toile::skin {

/// Where the left joints of the built-in body are at the height of 1.75 m [m]; those on the right mirror them in x = 0.
struct BuiltinJoints {
    Eigen::Vector3d pelvis, spine, chest, neck, head;
    Eigen::Vector3d clavicle, upper_arm, lower_arm, hand, fingertip;
    Eigen::Vector3d upper_leg, lower_leg, foot, toe;
};
BuiltinJoints builtin_joints(double girth);

/// The built-in body as an implicit shape at the height of 1.75 m: columns for trunk and limbs, smoothly united.
class BuiltinShape {
  public:
    explicit BuiltinShape(double girth);

    /// Negative inside; roughly a distance near the surface [m]. Mirror-symmetric in x = 0.
    double distance(const Eigen::Vector3d& point) const;

    /// A box that holds the body with some room [m].
    Eigen::Vector3d lower() const;
    Eigen::Vector3d upper() const;

  private:
    struct Part {
        std::vector<ImplicitColumn> column;  ///< one in the middle, or a mirrored pair
        double between;                      ///< width of the seam of a pair [m]
        double blend;                        ///< width of the seam to the parts before it [m]
    };
    void add(const ImplicitColumn& column, double blend);
    void add_pair(const ImplicitColumn& column, double between, double blend);
    void add_trunk();
    void add_head();
    void add_arms();
    void add_legs();

    double girth_;
    BuiltinJoints joint_;
    std::vector<Part> part_;
};

}  // namespace toile::skin

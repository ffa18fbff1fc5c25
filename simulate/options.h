#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace toile::simulate {

/// Contact of the cloth with a body, a table plane or a sphere.
struct ContactOptions {
    double thickness = 0.002;  ///< distance the cloth keeps from a surface [m], 0.0001 to 0.02
    double friction = 0.3;     ///< Coulomb coefficient, 0 to 2
};

/// Contact of the cloth with itself.
struct SelfContactOptions {
    double thickness = 0.0015;  ///< distance that layers keep [m], 0.0001 to 0.02
    double friction = 0.3;      ///< Coulomb coefficient, 0 to 2
};

/// The level set of the body.
struct LevelSetOptions {
    double voxel = 0.006;        ///< grid spacing [m], 0.001 to 0.02
    double error_bound = 0.001;  ///< the level set is rebuilt before the moving surface is off by more than three times
                                 ///< this on the way to a pose [m]; at the pose itself it is always made anew
};

/// A horizontal plane the cloth rests on, normal +y.
struct TableOptions {
    double height = 0.0;  ///< [m]
};

struct SphereOptions {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
    double radius = 0.2;                               ///< [m], above 0
};

/// What holds a vertex in place: its position in the garment's start.
struct PinOptions {
    std::vector<int> vertex;  ///< vertex indices
    std::string corners;      ///< "" or "top": the two upper corners of a patch's pattern
};

/// What `xpbd` has of its own.
struct XpbdOptions {
    int substeps = 20;        ///< small steps in one time step, 1 to 10000
    int iterations = 1;       ///< sweeps over all constraints in a small step, 1 to 1000
    bool keep_forces = true;  ///< a step starts from the last one's forces: rest is then exact whatever the step
};

/// What `bullet` has of its own.
struct BulletOptions {
    double substep = 0.0005;      ///< Bullet's fixed step, at most [s], 0.00001 to 0.1: a shorter one stretches less
    int position_iterations = 2;  ///< passes over links and contacts in a substep, 1 to 1000
    int settle_substeps = 20;     ///< substeps in one settling step, 1 to 10000
};

/// The integrator and what "at rest" means.
struct SolverOptions {
    std::string solver = "implicit";              ///< "implicit", "xpbd" or "bullet"
    double time_step = 0.033;                     ///< while the cloth moves [s], 0.0001 to 0.2
    double damping = 2.0;                         ///< mass-proportional, relative to the moving body [1/s], 0 to 1000
    Eigen::Vector3d gravity = {0.0, -9.81, 0.0};  ///< [m/s^2]
    double residual_tolerance = 5e-4;             ///< residual force over the garment's weight, 1e-9 to 0.1
    double speed_tolerance = 0.001;               ///< largest vertex speed at rest [m/s]
    int max_iterations = 5000;                    ///< to come to rest, 1 to 1000000
    int stall_iterations = 250;  ///< a drape ends when these lowered neither its residual by a tenth nor its energy
    XpbdOptions xpbd;
    BulletOptions bullet;
};

/// The way from the neutral drape to a pose.
struct ScheduleOptions {
    double joint_step = 0.12;        ///< largest rotation of any joint in one path step [rad], 0.005 to 1
    int path_iterations = 3;         ///< Newton iterations at most in a path step, 1 to 100
    double path_tolerance = 0.0005;  ///< a path step ends once an iteration moves no vertex further than this [m]
};

}  // namespace toile::simulate

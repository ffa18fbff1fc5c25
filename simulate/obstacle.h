#pragma once

#include <Eigen/Geometry>

#include "simulate/options.h"

namespace toile::simulate {

/// A solid the cloth touches. Within one time step each contact point is tied to one `piece` of the solid, a rigid part
/// that moves with it, so that distances are smooth in the point while a step is solved.
class Obstacle {
  public:
    virtual ~Obstacle() = default;

    struct Contact {
        double distance;           ///< signed [m], negative inside; far away any value above the contact thickness
        Eigen::Vector3d gradient;  ///< of the distance, about unit length; zero where the distance is clamped
    };
    virtual Contact sample(const Eigen::Vector3d& point, int piece) const = 0;
    virtual double distance(const Eigen::Vector3d& point, int piece) const { return sample(point, piece).distance; }

    /// Second derivatives of the distance [1/m], where they are worth knowing: zero by default.
    virtual Eigen::Matrix3d curvature(const Eigen::Vector3d& /*point*/, int /*piece*/) const {
        return Eigen::Matrix3d::Zero();
    }

    /// The piece for a point that was tied to `last`; `last` again where the point is far away. -1 stands for none yet.
    virtual int piece_near(const Eigen::Vector3d& /*point*/, int /*last*/) const { return 0; }
    /// Carries a point from the piece's own frame to the world, and back.
    virtual Eigen::Vector3d to_world(const Eigen::Vector3d& local, int /*piece*/) const { return local; }
    virtual Eigen::Vector3d to_local(const Eigen::Vector3d& world, int /*piece*/) const { return world; }
};

/// The half space below a horizontal plane.
class Table final : public Obstacle {
  public:
    explicit Table(const TableOptions& options) : options_(options) {}
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        return {point.y() - options_.height, Eigen::Vector3d::UnitY()};
    }

  private:
    TableOptions options_;
};

class Sphere final : public Obstacle {
  public:
    explicit Sphere(const SphereOptions& options) : options_(options) {}
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        const Eigen::Vector3d away = point - options_.center;
        const double length = away.norm();
        // The centre has no direction out: up is as good as any.
        return {length - options_.radius, length > 0.0 ? Eigen::Vector3d(away / length) : Eigen::Vector3d::UnitY()};
    }

  private:
    SphereOptions options_;
};

}  // namespace toile::simulate

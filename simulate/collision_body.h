#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "simulate/drape.h"
#include "simulate/obstacle.h"
#include "skin/level_set.h"
#include "skin/pose.h"

namespace toile::simulate {

/// The part of a body that a garment can reach, closed: what a level set is made of. Open boundaries, of the body
/// itself or of the cut, are capped by a fan around their mean. Topology only; shared by all poses.
struct ReachableSurface {
    Triangles triangle;                 ///< into body vertices, then cap centres
    std::vector<std::vector<int>> cap;  ///< body vertices around each cap centre
    int body_vertex_count = 0;
    std::vector<int> part_end;  ///< the row of `triangle` after the last of each part; a part is closed by itself
    double share = 1.0;         ///< of the body's triangles that are kept

    /// Body positions followed by the caps' centres.
    Positions positions(const Positions& posed_body) const;
};

/// Keeps what lies within about `reach` [m] of the cloth.
ReachableSurface reachable_surface(const Triangles& body_triangle, const Positions& posed_body, const Positions& cloth,
                                   double reach);
/// The same of each part of the body, lists of its triangles, one after the other.
ReachableSurface reachable_surface(const Triangles& body_triangle, const std::vector<std::vector<int>>& part,
                                   const Positions& posed_body, const Positions& cloth, double reach);

/// The level set of what of a posed body the cloth can reach, the union of those of its parts.
struct BodyLevelSet {
    std::shared_ptr<const std::vector<std::vector<int>>> part;  ///< see simulate/body_parts.h
    ReachableSurface surface;
    skin::LevelSet level_set;

    BodyLevelSet(const skin::Body& body, const Positions& posed_body, const Positions& cloth, double voxel,
                 double thickness);
    /// In a pose, with the parts that another pose has found.
    BodyLevelSet(const skin::Body& body, std::shared_ptr<const std::vector<std::vector<int>>> part,
                 const Positions& posed_body, const Positions& cloth, double voxel, double thickness);
};

/// The moving body as an obstacle: a level set, made anew when the body has deformed too much, and carried along
/// rigidly piece by piece in between. A piece is a body vertex with the blended rotation of its joints.
class CollisionBody final : public Obstacle {
  public:
    CollisionBody(const skin::Body& body, skin::SkinningMethod method, const LevelSetOptions& options,
                  double thickness);

    /// Sets out from a pose whose level set is there already.
    void start(const skin::Pose& pose, std::shared_ptr<const BodyLevelSet> built);
    /// Moves the body.
    void move_to(const skin::Pose& pose, DrapeReport& report);
    /// Makes the level set fit the body where it is now, with the cloth `[V x 3]` on it. `exact` makes it anew whatever
    /// the error; else it is made, coarser, only where the carried one would be off by too much (see `carried_error`).
    void fit_level_set(bool exact, const Positions& cloth, DrapeReport& report);

    /// Where the last move takes a point that is tied to `piece`.
    Eigen::Vector3d carry(const Eigen::Vector3d& point, int piece) const;

    Contact sample(const Eigen::Vector3d& point, int piece) const override;
    double distance(const Eigen::Vector3d& point, int piece) const override;
    Eigen::Matrix3d curvature(const Eigen::Vector3d& point, int piece) const override;
    int piece_near(const Eigen::Vector3d& point, int last) const override;
    Eigen::Vector3d to_world(const Eigen::Vector3d& local, int piece) const override;
    Eigen::Vector3d to_local(const Eigen::Vector3d& world, int piece) const override;

    const Positions& position() const { return now_.position; }  ///< posed body `[Vb x 3]`

  private:
    struct State {
        Positions position;
        std::vector<Eigen::Matrix3d> frame;        // of the surface: columns tangent, bitangent, normal
        std::vector<Eigen::Quaterniond> rotation;  // blended from the joints: smoother, for what is further away
        skin::Pose pose;
    };
    State state_at(const skin::Pose& pose) const;
    void use(std::shared_ptr<const BodyLevelSet> built);
    /// How far the surface near each piece in use is from where the piece's rigid motion carries it, along the normal:
    /// from the neighbours of the piece's vertex, the largest of all [m].
    double carried_error() const;
    Eigen::Vector3d to_built(const Eigen::Vector3d& world, int piece) const;

    const skin::Body& body_;
    skin::SkinningMethod method_;
    LevelSetOptions options_;
    double thickness_;
    std::vector<std::vector<int>> neighbour_;   // of each body vertex in reach
    mutable std::vector<std::uint8_t> in_use_;  // pieces points are tied to
    State built_, before_, now_;
    std::vector<Eigen::Matrix3d> since_built_;  // rotation of each piece since the level set was built
    std::shared_ptr<const BodyLevelSet> level_set_;
    std::optional<skin::LevelSet::Sampler> sampler_;
};

}  // namespace toile::simulate

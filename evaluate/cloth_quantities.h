#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "evaluate/quantity.h"
#include "prior/quasistatic.h"
#include "skin/surface_query.h"

namespace toile::evaluate {

/// What is drawn on a cloth, by vertex `[V]`.
struct ClothFields {
    Eigen::VectorXd distance;  ///< to the target [m]
    Eigen::VectorXd stretch;   ///< l/l̄ of the incident edge furthest from 1; 1 without edges
    Eigen::VectorXd strain;    ///< largest principal stretch minus 1, area-weighted mean over the triangles around
};

/// Unit vertex normals `[V x 3]`, each the area-weighted mean of its triangles' normals; zero where that is shorter
/// than a billionth of what it is the sum of, or there is none.
Positions area_weighted_normals(const Triangles& triangle, const Positions& position);

/// A sample's truth, prepared: its cloths are judged against it, and against the body it lies on.
struct JudgedTarget {
    Positions position;                                    ///< `[V x 3]` r_T [m]
    Positions normal;                                      ///< `[V x 3]` as of `area_weighted_normals`
    double stretching_energy = 0, compression_energy = 0;  ///< [J]
    std::shared_ptr<const skin::SurfaceQuery> body;        ///< the body in the sample's pose; null without one
    Eigen::VectorXd body_distance;                         ///< `[V]` of r_T, negative inside [m]
};

/// Judges cloths of one mesh. Immutable; any number of threads may ask it.
class ClothJudge {
  public:
    /// An edge counts as overstretched beyond (1 + `overstretched_limit`) times its rest length; a hundred-thousandth
    /// more is let pass, since the priors hold a limit up to their tolerance. Throws Error for what `rest_state` does.
    ClothJudge(const ClothMesh& mesh, double overstretched_limit, const std::string& where = {},
               const prior::QuasistaticStiffness& stiffness = {});

    JudgedTarget target(Positions position, std::shared_ptr<const skin::SurfaceQuery> body = nullptr) const;
    /// Values of a cloth `[V x 3]` [m], in the units of `quantity_kind`. All are NaN where the cloth is not finite.
    /// Vertices without a normal, here or in the target, do not count in the mean angle.
    QuantityValues judge(const Positions& cloth, const JudgedTarget& target) const;
    ClothFields fields(const Positions& cloth, const Positions& target) const;

    const ClothMesh& mesh() const { return mesh_; }

  private:
    struct Edges {
        double stretching = 0, compression = 0;  ///< [J]
        int overstretched = 0;
        double largest = 0;  ///< l / l̄
    };
    Edges judge_edges(const Positions& cloth) const;
    Eigen::VectorXd vertex_strain(const Positions& cloth) const;

    ClothMesh mesh_;
    prior::QuasistaticModel model_;
    double overstretched_limit_;
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> rest_metric_;  ///< `[F x 3]` e1·e1, e1·e2, e2·e2 [m²]
};

/// Depth of the deepest vertex below a body's surface [m], 0 where none is: the winding number decides, deepest first,
/// whether a vertex that the surface's nearest point has inside really is. `known` are places `[V x 3]` with their
/// signed distances `[V]`: a vertex nearer to its known place than that place is to the body needs no query. A vertex
/// whose nearest point lies on a part of the surface that the body itself buries may be missed.
double deepest_penetration(const skin::SurfaceQuery& body, const Positions& cloth, const Positions& known,
                           const Eigen::VectorXd& known_distance);

}  // namespace toile::evaluate

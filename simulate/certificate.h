#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"

namespace toile::simulate {

/// A vertex faster than this counts as moving [m/s]: GarmentCode's 0.03 cm in a frame of 1/60 s.
inline constexpr double moving_speed = 0.018;

/// Rungs of the ladder, see simulate/ladder.h.
inline constexpr int rung_count = 4;

/// What came of one rung.
struct RungOutcome {
    int status = -1;             ///< a DrapeStatus; -1: not tried
    double residual_force = -1;  ///< as in `Certificate`; -1: not tried
};

/// The proof stored with each sample (contract: /certificate/*).
struct Certificate {
    double residual_force = 0;    ///< Euclidean norm of all nodal net forces over the garment's weight
    double body_penetration = 0;  ///< deepest vertex below the body's mesh [m], 0 where none is
    int body_crossings = 0;       ///< pairs of a cloth and a body triangle that meet, exactly
    int self_intersections = 0;   ///< pairs of cloth triangles that meet, exactly
    double max_stretch = 0;       ///< largest edge length over rest length
    double min_stretch = 0;
    double max_speed = 0;     ///< largest vertex speed at the end [m/s]
    double moving_share = 0;  ///< of the vertices that are faster than `moving_speed` at the end
    int iterations = 0;       ///< of the solver, over all tries
    int path_steps = 0;       ///< over all tries
    int tries = 1;            ///< drapes it took, see simulate/ladder.h
    int rung = 0;             ///< which try is the one kept
    double seconds = 0;       ///< wall time, over all tries [s]
    std::array<RungOutcome, rung_count> rungs = {};
};

/// 0 accepted; anything else names why a sample is not.
enum class DrapeStatus {
    accepted = 0,
    not_at_rest = 1,  ///< residual force or speed above the gate when the iteration budget ended
    penetrates_body = 2,
    overstretched = 3,
    not_finite = 4,
    self_intersects = 5,
    body_intersects_itself = 6,  ///< not accepted, and the body's pose is the reason, see simulate/body_intersection.h
    // The two below come from the process a drape ran in, never from a solver.
    crashed = 7,        ///< the process died of it, twice
    out_of_memory = 8,  ///< it needed more memory than there was, twice
};
inline constexpr int drape_status_count = 9;

/// Whether the sample has no cloth because its process ended; it may come out well where there is more memory.
constexpr bool process_failed(DrapeStatus status) {
    return status == DrapeStatus::crashed || status == DrapeStatus::out_of_memory;
}

std::string_view status_reason(DrapeStatus status);
std::vector<std::string_view> status_reasons();  ///< index = status, for the attribute `reasons`

/// Rest length of each edge `[E]` [m]: the mean of its pattern lengths over its triangles (contract, mesh group).
Eigen::VectorXd edge_rest_lengths(const ClothMesh& mesh, const Topology& topology);

struct StretchRange {
    double largest, smallest;  ///< edge length over rest length
};
StretchRange stretch_range(const Topology& topology, const Eigen::VectorXd& rest_length, const Positions& position);

/// How deep the deepest cloth vertex lies below the body's mesh [m], 0 where none does. Against the triangles; the
/// level set's distances `[V]` tell only which vertices to look at twice, and how deep one lies that two parts of the
/// body enclose.
double body_penetration(const Triangles& body_triangle, const Positions& posed_body, const Positions& cloth,
                        const Eigen::VectorXd& level_set_distance = {});

}  // namespace toile::simulate

#pragma once

#include <array>
#include <string_view>

#include "cloth/types.h"
#include "evaluate/random.h"

namespace toile::evaluate {

/// What a prediction looks like: from what a good predictor gives to what nobody would.
enum class PredictionKind {
    noise,          ///< the bent cloth with white noise
    low_frequency,  ///< with errors that vary slowly
    mixed,          ///< with both
    feasible,       ///< shrunk until every edge is below its limit
    rest,           ///< the rest position itself
    stretched,      ///< blown up by a factor
    point,          ///< all vertices at one point
    line,           ///< on a line
    plane,          ///< in a plane across the cloth
    mirrored,       ///< inside out
    shuffled,       ///< each vertex where another one belongs
    shrunk,         ///< to a millimetre
    far_vertex,     ///< one vertex a hundred metres away
    far_away,       ///< all of it a kilometre off
    torn            ///< half of it ten cloth sizes away
};
inline constexpr int prediction_kind_count = 15;

std::string_view name(PredictionKind kind);

/// Smooth random displacements `[V x 3]`: waves of a quarter of the cloth to twice its size; root mean square 1.
Positions smooth_field(const Positions& rest, Random& random);
/// White noise `[V x 3]`; root mean square 1.
Positions white_field(int vertices, Random& random);

/// The rest position rolled up about an axis by up to half a turn: a flat cloth keeps its lengths.
Positions bent(const Positions& rest, Random& random);

/// A predictor's output for the speed table: the bent cloth, off by `rms` [m] (root mean square over vertices), of
/// which `white_share` (0 to 1) is white noise and the rest smooth.
Positions predicted_positions(const Positions& rest, double rms, double white_share, Random& random);

/// A prediction of the stress run. `edge_length` and positions in metres; `noise` in edge lengths.
Positions extreme_positions(const Positions& rest, PredictionKind kind, double edge_length, double noise,
                            double stretch_limit, Random& random);

}  // namespace toile::evaluate

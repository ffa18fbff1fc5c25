#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "simulate/certificate.h"
#include "simulate/gate.h"
#include "simulate/ladder.h"
#include "simulate/material.h"
#include "simulate/options.h"
#include "simulate/wind.h"
#include "skin/body.h"
#include "skin/pose.h"
#include "skin/skinning.h"

namespace toile::simulate {

/// Everything a drape depends on. What is absent is not built: no body, no level set; no bending, no hinges; neither
/// body, table nor sphere, no contact code.
struct DrapeScene {
    ClothMesh mesh;  ///< with masses; `rest_position` is where the neutral drape starts
    MembraneOptions membrane;
    std::optional<BendingOptions> bending;
    std::optional<StrainLimitOptions> strain_limit;  ///< unknown to `bullet`
    std::optional<WindOptions> wind;
    std::optional<ContactOptions> contact;  ///< required by body, table and sphere
    std::optional<SelfContactOptions> self_contact;
    std::optional<skin::Body> body;
    skin::SkinningMethod skinning = skin::SkinningMethod::linear;
    LevelSetOptions level_set;
    std::optional<TableOptions> table;
    std::optional<SphereOptions> sphere;
    std::vector<int> pinned;  ///< vertices held where they start
    SolverOptions solver;
    ScheduleOptions schedule;
    GateOptions gate;
    LadderOptions ladder;
};

/// Where the time of one drape went [s], and counts.
struct DrapeReport {
    double level_set_seconds = 0, contact_seconds = 0, self_contact_seconds = 0, assembly_seconds = 0,
           factor_seconds = 0, line_search_seconds = 0, certificate_seconds = 0;
    int path_steps = 0, level_sets = 0, iterations = 0, line_search_halvings = 0;
    int untangled = 0;  ///< crossings of edges with triangles that were taken out of the start
};

struct DrapeResult {
    Positions position;  ///< `[V x 3]` [m]
    Certificate certificate;
    DrapeStatus status = DrapeStatus::accepted;
    DrapeReport report;            ///< of the try that is kept
    std::vector<TryRecord> tries;  ///< all of them, in order
};

/// Told of a drape's energy (`Solver::energy`) before each step towards rest, the solids standing still. `first` where
/// the cloth sets out towards rest, again at each try.
struct EnergySample {
    double energy;            ///< [J]
    double held_by_friction;  ///< `Solver::held_by_friction` [J]
    bool first;
};
using EnergyWatch = std::function<void(const EnergySample&)>;

struct DrapeModel;

/// Drapes one garment on one body, pose after pose. Construction does what all poses share (stencils, sparsity,
/// ordering); `drape` is const and may run from several threads, its result depending on its arguments alone.
class Draper {
  public:
    explicit Draper(const DrapeScene& scene);
    ~Draper();

    /// From `scene.mesh.rest_position` to rest in the neutral pose. `position` of the result is what `drape` starts
    /// from.
    DrapeResult drape_neutral(const EnergyWatch& watch = {}) const;
    /// From the neutral drape along interpolated poses to `pose`, and on until it rests. A drape that misses the gate
    /// climbs the ladder (simulate/ladder.h).
    DrapeResult drape(const Positions& neutral_drape, const skin::Pose& pose, const EnergyWatch& watch = {}) const;

  private:
    std::unique_ptr<const DrapeModel> model_;
};

}  // namespace toile::simulate

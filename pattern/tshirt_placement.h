#pragma once

#include <vector>

#include "pattern/body_measure.h"
#include "pattern/panel_mesh.h"
#include "pattern/torso_wrap.h"
#include "pattern/tshirt_draft.h"

namespace toile::pattern {

/// Lays the panels of a T-shirt around a body: front and back on the trunk's wrap, the sleeves on tubes from the
/// armholes to rings around the arms. Result: `[P_p x 3]` for each panel [m]; seams nearly meet.
std::vector<Positions> place_tshirt(const BodyMeasure& measure, const TorsoWrap& wrap, double underarm_height,
                                    double tip_half_width, const TshirtDraft& draft, const std::vector<Panel>& panel,
                                    const std::vector<PanelMesh>& mesh);

}  // namespace toile::pattern

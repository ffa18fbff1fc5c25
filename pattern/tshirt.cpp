#include "pattern/tshirt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "cloth/error.h"
#include "pattern/body_measure.h"
#include "pattern/settle.h"
#include "pattern/torso_wrap.h"
#include "pattern/tshirt_draft.h"
#include "pattern/tshirt_placement.h"

namespace toile::pattern {
namespace {

void check_range(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    std::ostringstream text;
    text << "T-shirt option " << name << " is " << value << "; allowed are " << low << " to " << high;
    throw Error(text.str());
}

void check_options(const TshirtOptions& options) {
    check_range("edge_length", options.edge_length, 0.006, 0.05);
    check_range("ease", options.ease, 0.02, 0.6);
    if (options.body_length != 0.0) check_range("body_length", options.body_length, 0.3, 1.5);
    if (options.sleeve_length != 0.0) check_range("sleeve_length", options.sleeve_length, 0.08, 0.8);
}

/// The cloth passes below the notch between arm and trunk where both sides leave it room.
double underarm_height(const BodyMeasure& measure, double clearance) {
    double height = std::numeric_limits<double>::infinity();
    for (const ArmMeasure& arm : measure.arm) {
        // Half the angle between arm and flank: the notch direction halves it.
        const double half_angle = std::acos(std::clamp(-arm.notch_direction.y(), 0.0, 1.0));
        const double below = std::clamp(clearance / std::max(std::sin(half_angle), 0.05), 0.03, 0.06);
        height = std::min(height, (arm.notch + below * arm.notch_direction).y());
    }
    return height;
}

/// Quarter circumferences: wide enough for the chest with its ease, and for the hips at the hem.
void fit_trunk(const TorsoWrap& wrap, const BodyMeasure& measure, double underarm, const TshirtOptions& options,
               TshirtDraft& draft) {
    double wanted = measure.chest * (1.0 + options.ease), at_hem = wanted;
    for (double down = 0.0; down <= draft.length_below; down += 0.01) {
        const double needed = wrap.tape(underarm - down) * (1.0 + 0.6 * options.ease),
                     share = down / draft.length_below;
        // The hem widens where the line from chest to hem would be too narrow; near the chest, the chest does.
        const double here = (1.0 - share) * wanted + share * at_hem;
        if (needed <= here) continue;
        (share > 0.4 ? at_hem : wanted) += (needed - here) / (share > 0.4 ? share : 1.0 - share);
    }
    draft.half_chest = 0.25 * wanted;
    draft.half_hem = 0.25 * at_hem;
}

TshirtDraft draft_tshirt(const TorsoWrap& wrap, const BodyMeasure& measure, double underarm,
                         const TorsoWrap::Options& fit, const TshirtOptions& options) {
    TshirtDraft draft{};
    draft.edge_length = options.edge_length;
    draft.half_tip = 1.03 * fit.tip_half_width;
    draft.half_neck = fit.neck_half_width;
    auto column = [&](TorsoWrap::Half half, double x) {
        return std::max(wrap.column_length(half, x), wrap.column_length(half, -x));
    };
    double rise = 0.0;
    for (TorsoWrap::Half half : {TorsoWrap::front, TorsoWrap::back}) {
        draft.tip_height[half] = column(half, fit.tip_half_width);
        rise += 0.5 * (column(half, fit.neck_half_width) - draft.tip_height[half]);
    }
    draft.shoulder_rise = std::clamp(rise, 0.1 * (draft.half_tip - draft.half_neck), draft.half_tip - draft.half_neck);
    draft.neck_drop[0] = std::min(1.1 * draft.half_neck, 0.5 * draft.tip_height[0]);
    draft.neck_drop[1] = 0.02;
    draft.length_below = underarm - fit.lowest_height;
    fit_trunk(wrap, measure, underarm, options, draft);
    fit_sleeve(draft, 0.5 * 1.12 * std::max(measure.arm[0].circumference, measure.arm[1].circumference));
    const double upper = (measure.arm[0].elbow - measure.arm[0].shoulder).norm();
    const double sleeve = options.sleeve_length > 0.0 ? options.sleeve_length : 0.75 * upper;
    draft.sleeve_below = std::max(sleeve - draft.cap_height, 0.05);
    return draft;
}

std::string describe(const BodyMeasure& measure, const TshirtDraft& draft, const Garment& garment,
                     const SettleReport& settled) {
    std::ostringstream text;
    text.precision(3);
    text << "T-shirt cut for a chest of " << measure.chest << " m: width " << 2.0 * draft.half_chest << " m, length "
         << draft.length_below + draft.tip_height[0] + draft.shoulder_rise << " m, " << garment.mesh.vertex_count()
         << " vertices; it starts " << 1000.0 * settled.nearest << " mm off the body, its edges at "
         << settled.min_stretch << " to " << settled.max_stretch << " of their rest length";
    return text.str();
}

}  // namespace

Garment make_tshirt(const skin::Body& body, const TshirtOptions& options) {
    check_options(options);
    const BodyMeasure measure = measure_body(body);
    const double h = options.edge_length;
    // Chords cut into the round: sagitta of an edge on a limb of 4 cm radius.
    const double clearance = 0.008 + h * h / (8.0 * 0.04);
    TorsoWrap::Options fit;
    fit.clearance = clearance + 0.002;
    fit.underarm_height = underarm_height(measure, fit.clearance);
    fit.neck_half_width = std::min(1.7 * measure.neck_half_width, 0.6 * measure.shoulder_half_width);
    fit.tip_half_width = measure.shoulder_half_width + 0.012;
    const double trunk = measure.underarm_height - measure.hip_height;
    fit.lowest_height = measure.hip_height - 0.12 * trunk;
    if (options.body_length > 0.0)
        fit.lowest_height = std::min(measure.neck_height - options.body_length, fit.underarm_height - 0.1);
    const TorsoWrap wrap(body, measure, fit);
    const TshirtDraft draft = draft_tshirt(wrap, measure, fit.underarm_height, fit, options);

    const std::vector<Panel> panel = cut_panels(draft);
    std::vector<PanelMesh> mesh;
    for (const Panel& p : panel) mesh.push_back(mesh_panel(outline(p), h));
    const std::vector<Positions> position =
        place_tshirt(measure, wrap, fit.underarm_height, fit.tip_half_width, draft, panel, mesh);
    Garment garment = sew(panel, mesh, tshirt_seams(), position, 0.05);
    SettleOptions settling;
    settling.clearance = clearance;
    const SettleReport settled = settle(garment.mesh, body, settling);
    garment.remarks.push_back(describe(measure, draft, garment, settled));
    check_cloth_mesh(garment.mesh, {});
    return garment;
}

}  // namespace toile::pattern

#include "pattern/patch.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "cloth/error.h"
#include "pattern/panel_mesh.h"
#include "pattern/sewing.h"

namespace toile::pattern {
namespace {

void check_range(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    std::ostringstream text;
    text << "patch option " << name << " is " << value << "; allowed are " << low << " to " << high;
    throw Error(text.str());
}

PanelSide straight_side(const char* name, const Eigen::RowVector2d& from, const Eigen::RowVector2d& to,
                        double edge_length) {
    const int pieces = std::max(1, static_cast<int>(std::lround((to - from).norm() / edge_length)));
    PanelSide side = {name, PlanePositions(pieces + 1, 2)};
    for (int k = 0; k <= pieces; ++k) side.line.row(k) = from + (to - from) * k / pieces;
    side.line.row(pieces) = to;
    return side;
}

}  // namespace

Garment make_patch(const PatchOptions& options) {
    check_range("width", options.width, 0.02, 10.0);
    check_range("height", options.height, 0.02, 10.0);
    check_range("edge_length", options.edge_length, 0.002, 0.5 * std::min({options.width, options.height, 2.0}));
    const double right = 0.5 * options.width, top = options.height, h = options.edge_length;
    const Panel panel = {
        "patch",
        {straight_side("bottom", {-right, 0}, {right, 0}, h), straight_side("right", {right, 0}, {right, top}, h),
         straight_side("top", {right, top}, {-right, top}, h), straight_side("left", {-right, top}, {-right, 0}, h)}};
    const PanelMesh mesh = mesh_panel(outline(panel), h);
    Positions position = Positions::Zero(mesh.position.rows(), 3);
    position.col(0) = mesh.position.col(0);
    if (options.orientation == PatchOrientation::vertical)
        position.col(1) = mesh.position.col(1).array() - top;
    else
        position.col(2) = 0.5 * top - mesh.position.col(1).array();
    Garment garment = sew({panel}, {mesh}, {}, {position}, 0.0);
    check_cloth_mesh(garment.mesh, {});
    return garment;
}

}  // namespace toile::pattern

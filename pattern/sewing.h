#pragma once

#include <string>
#include <vector>

#include "pattern/garment.h"
#include "pattern/panel_mesh.h"

namespace toile::pattern {

/// One side of a panel's outline: a line from one corner to the next, cut into pieces.
struct PanelSide {
    std::string name;
    PlanePositions line;  ///< `[N x 2]` its points, both corners included [m]
};

/// A panel as it is cut: its sides in counter-clockwise order, each starting where the one before ends.
struct Panel {
    std::string name;
    std::vector<PanelSide> side;
};

/// Two sides that are sewn together, the end of one to the start of the other. Both have the same number of points.
struct Seam {
    int panel, side, other_panel, other_side;
};

/// A panel's outline `[N x 2]`, each corner once.
PlanePositions outline(const Panel& panel);

/// Where the points of a side lie in the outline, in its order.
std::vector<int> side_points(const Panel& panel, int side);

/// Welds meshed panels along their seams. `position[p]` `[P_p x 3]` are the places of a panel's points in space; what
/// is welded goes to the mean. The panels are laid beside each other in the pattern plane, `gap` [m] apart. Throws
/// Error where two sides of a seam differ in number of points.
Garment sew(const std::vector<Panel>& panel, const std::vector<PanelMesh>& mesh, const std::vector<Seam>& seam,
            const std::vector<Positions>& position, double gap);

/// Lays panels beside each other in a row, `gap` [m] apart, bottoms on v = 0, by moving pattern positions.
/// `pattern_panel` `[P]` tells the panel of each pattern position.
void lay_apart(PlanePositions& pattern_position, const std::vector<int>& pattern_panel, double gap);

}  // namespace toile::pattern

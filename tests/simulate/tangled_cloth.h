#pragma once

#include <cmath>

#include "tests/simulate/cloth_square.h"

namespace toile::test {

/// A mesh without a pattern: what crossings are about.
struct Surface {
    Triangles triangle;
    Positions position;
};

inline Surface surface(const ClothMesh& mesh) {
    return {mesh.triangle, mesh.rest_position};
}

/// Both surfaces in one mesh, the first one's vertices first.
inline Surface joined(const Surface& first, const Surface& second) {
    Surface both;
    both.position.resize(first.position.rows() + second.position.rows(), 3);
    both.position << first.position, second.position;
    both.triangle.resize(first.triangle.rows() + second.triangle.rows(), 3);
    both.triangle << first.triangle, (second.triangle.array() + static_cast<int>(first.position.rows())).matrix();
    return both;
}

/// Two layers 3 mm apart, about 0.2 m wide; a bump of the lower one reaches `depth` [m] through the upper one.
inline Surface layers_with_bump(double depth) {
    Surface lower = surface(cloth_square(20, 0.2, 0.0));
    const Surface upper = surface(cloth_square(19, 0.21, 0.003));
    for (int v = 0; v < lower.position.rows(); ++v) {
        const double r = std::hypot(lower.position(v, 0) - 0.013, lower.position(v, 2) + 0.011);
        lower.position(v, 1) += (0.003 + depth) * std::exp(-r * r / (2.0 * 0.03 * 0.03));
    }
    return joined(lower, upper);
}

/// A corner of a leaning sheet, `depth` [m] through the middle of a flat one.
inline Surface corner_through_sheet(double depth) {
    Surface corner = surface(cloth_square(12, 0.12, 0.0));
    const double c = std::sqrt(0.5), half_diagonal = 0.12 * c;
    for (int v = 0; v < corner.position.rows(); ++v) {
        const double across = c * (corner.position(v, 0) - corner.position(v, 2));
        const double along = c * (corner.position(v, 0) + corner.position(v, 2));
        corner.position.row(v) << 0.0113 + 0.3 * across, along + half_diagonal - depth, across + 0.0171;
    }
    return joined(surface(cloth_square(20, 0.2, 0.0)), corner);
}

/// One sheet folded over, 16 mm between its halves; a tip of the lower half reaches 8 mm through the upper one.
inline Surface fold_with_tip() {
    Surface fold = surface(cloth_square(30, 0.24, 0.0));
    const double flat = 0.1, radius = 0.008;
    for (int v = 0; v < fold.position.rows(); ++v) {
        const double s = fold.position(v, 0) + 0.12, z = fold.position(v, 2), turn = (s - flat) / radius;
        if (s < flat) {
            const double r = std::hypot(s - 0.06, z - 0.01);
            fold.position.row(v) << s, (2.0 * radius + 0.008) * std::exp(-r * r / (2.0 * 0.015 * 0.015)), z;
        } else if (turn < M_PI) {
            fold.position.row(v) << flat + radius * std::sin(turn), radius * (1.0 - std::cos(turn)), z;
        } else {
            fold.position.row(v) << flat - (s - flat - M_PI * radius), 2.0 * radius, z;
        }
    }
    return fold;
}

/// One sheet hanging down from both sides of a seam at an angle of 17 degrees, one side pushed `depth` [m] through the
/// other from the seam downwards: an armpit. The contour ends at the seam, where the sheet crosses itself.
inline Surface armpit(double depth) {
    Surface sheet = surface(cloth_square(30, 0.3, 0.0));
    for (int v = 0; v < sheet.position.rows(); ++v) {
        const double s = sheet.position(v, 0), z = sheet.position(v, 2), down = std::abs(s);
        double x = s * std::sin(0.15);
        const double r = std::hypot(down - 0.03, z - 0.005);
        const double pushed = std::exp(-r * r / (2.0 * 0.03 * 0.03)) * std::min(1.0, down / 0.01);
        if (s > 0.0) x -= (2.0 * down * std::sin(0.15) + depth) * pushed;
        sheet.position.row(v) << x + 0.0003 * std::sin(17.0 * z), -down * std::cos(0.15), z;
    }
    return sheet;
}

/// Two layers 1 mm apart, every vertex moved by up to 0.3 edge lengths in each direction.
inline Surface noisy_layers() {
    Surface both = joined(surface(cloth_square(15, 0.15, 0.0)), surface(cloth_square(15, 0.15, 0.001)));
    both.position = crumpled(both.position, 0.003);
    return both;
}

}  // namespace toile::test

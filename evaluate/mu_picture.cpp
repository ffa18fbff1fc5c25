#include "evaluate/mu_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "files/binary_text.h"
#include "files/hdf5_file.h"
#include "files/mesh_group.h"
#include "generate/rendering.h"

namespace toile::evaluate {
namespace {

using generate::Color;
using generate::RenderedSurface;

constexpr int width = 720, margin = 16, letter = 6;  // [pixels]
constexpr double gap = 0.04;                         // between panels, as a share of the widest
constexpr int bar_steps = 64;

/// From purple (0) over green to yellow (1), of even steps to the eye: viridis at quarters.
Color map_color(double share) {
    constexpr std::array<Color, 5> anchor{{{0.267, 0.005, 0.329},
                                           {0.230, 0.322, 0.546},
                                           {0.128, 0.567, 0.551},
                                           {0.369, 0.789, 0.383},
                                           {0.993, 0.906, 0.144}}};
    const double place = 4.0 * std::clamp(share, 0.0, 1.0);
    const auto k = static_cast<size_t>(std::min(place, 3.0));
    Color color;
    for (size_t c = 0; c < 3; ++c)
        color[c] = anchor[k][c] + (place - static_cast<double>(k)) * (anchor[k + 1][c] - anchor[k][c]);
    return color;
}

/// The logarithmic scale of one picture.
struct Scale {
    explicit Scale(const Eigen::VectorXd& mu) : low(std::log(mu.minCoeff())), high(std::log(mu.maxCoeff())) {
        if (high - low < 1e-6) {  // one number: the middle of a scale about it
            low -= 0.5;
            high += 0.5;
        }
    }
    Color color(double mu) const { return map_color((std::log(mu) - low) / (high - low)); }
    double low, high;
};

/// A surface to be drawn in a plane, before it has its place there, with the cloth's vertex at each corner.
struct Panel {
    Triangles triangle;       // `[F x 3]`
    Positions position;       // `[P x 3]`
    std::vector<int> vertex;  // `[P]` of the cloth

    Eigen::RowVector3d low() const { return position.colwise().minCoeff(); }
    Eigen::RowVector3d size() const { return position.colwise().maxCoeff() - low(); }
};

/// The connected pieces of the flat pattern.
std::vector<Panel> pattern_panels(const ClothMesh& mesh) {
    const int corners = static_cast<int>(mesh.pattern_position.rows());
    const std::vector<int> piece = connected_components(mesh.pattern_triangle, corners);
    std::vector<int> vertex(static_cast<size_t>(corners), -1);
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f)
        for (int c = 0; c < 3; ++c) vertex[static_cast<size_t>(mesh.pattern_triangle(f, c))] = mesh.triangle(f, c);
    std::vector<Panel> panels;
    for (int k = 0; k <= *std::max_element(piece.begin(), piece.end()); ++k) {
        Panel panel;
        std::vector<int> number(static_cast<size_t>(corners), -1), row;
        for (int p = 0; p < corners; ++p) {
            if (piece[static_cast<size_t>(p)] != k || vertex[static_cast<size_t>(p)] < 0) continue;
            number[static_cast<size_t>(p)] = static_cast<int>(row.size());
            row.push_back(p);
            panel.vertex.push_back(vertex[static_cast<size_t>(p)]);
        }
        if (row.empty()) continue;
        panel.position = Positions::Zero(static_cast<Eigen::Index>(row.size()), 3);
        panel.position.leftCols(2) = mesh.pattern_position(row, Eigen::all);
        std::vector<int> face;
        for (int f = 0; f < mesh.triangle_count(); ++f)
            if (number[static_cast<size_t>(mesh.pattern_triangle(f, 0))] >= 0) face.push_back(f);
        panel.triangle =
            mesh.pattern_triangle(face, Eigen::all).unaryExpr([&](int p) { return number[static_cast<size_t>(p)]; });
        panels.push_back(std::move(panel));
    }
    return panels;
}

/// The cloth as worn, from the front and from the back.
std::vector<Panel> worn_panels(const ClothMesh& mesh) {
    Panel front{mesh.triangle, mesh.rest_position, {}};
    for (int v = 0; v < mesh.vertex_count(); ++v) front.vertex.push_back(v);
    Panel back = front;
    back.position.col(0) *= -1.0;
    back.position.col(2) *= -1.0;
    return {front, back};
}

/// Puts the panels into rows, left to right, no wider than about twice the widest; returns the size of all [m].
Eigen::Vector2d lay_out(std::vector<Panel>& panels) {
    double widest = 0.0, area = 0.0;
    for (const Panel& panel : panels) {
        widest = std::max(widest, panel.size().x());
        area += panel.size().x() * panel.size().y();
    }
    const double space = gap * widest, row_width = std::max(widest, 1.5 * std::sqrt(area)) + space;
    Eigen::Vector2d all(0, 0);
    double x = 0.0, y = 0.0, row_height = 0.0;
    for (Panel& panel : panels) {
        const Eigen::RowVector3d low = panel.low(), size = panel.size();
        if (x > 0.0 && x + size.x() > row_width) {
            y -= row_height + space;
            x = row_height = 0.0;
        }
        panel.position.rowwise() += Eigen::RowVector3d(x - low.x(), y - size.y() - low.y(), 0.0);
        x += size.x() + space;
        row_height = std::max(row_height, size.y());
        all = all.cwiseMax(Eigen::Vector2d(x - space, row_height - y));
    }
    return all;
}

/// A bar of all colours, `size` large from its upper left corner.
RenderedSurface color_bar(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
    RenderedSurface bar;
    bar.position.resize(2 * (bar_steps + 1), 3);
    bar.triangle.resize(2 * bar_steps, 3);
    for (int k = 0; k <= bar_steps; ++k) {
        const double share = static_cast<double>(k) / bar_steps;
        for (int side = 0; side < 2; ++side) {
            bar.position.row(2 * k + side) << corner.x() + share * size.x(), corner.y() - side * size.y(), 0.0;
            bar.color.push_back(map_color(share));
        }
        if (k < bar_steps) {
            bar.triangle.row(2 * k) << 2 * k, 2 * k + 1, 2 * k + 2;
            bar.triangle.row(2 * k + 1) << 2 * k + 1, 2 * k + 3, 2 * k + 2;
        }
    }
    return bar;
}

double quantile(const Eigen::VectorXd& mu, double share) {
    std::vector<double> sorted(mu.data(), mu.data() + mu.size());
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void check(const ClothMesh& mesh, const Eigen::VectorXd& mu) {
    if (mu.size() != mesh.vertex_count() || mu.size() == 0)
        throw Error("mu has " + std::to_string(mu.size()) + " values for " + std::to_string(mesh.vertex_count()) +
                    " vertices");
    if (!(mu.minCoeff() > 0.0) || !mu.allFinite()) throw Error("mu is not positive everywhere");
}

}  // namespace

files::Picture mu_picture(const ClothMesh& mesh, const Eigen::VectorXd& mu) {
    check(mesh, mu);
    const Scale scale(mu);
    std::vector<Panel> panels = mesh.pattern_position.rows() > 0 ? pattern_panels(mesh) : worn_panels(mesh);
    const Eigen::Vector2d size = lay_out(panels);
    std::vector<RenderedSurface> surface;
    for (Panel& panel : panels) {
        RenderedSurface& one = surface.emplace_back(RenderedSurface{panel.triangle, panel.position, {}});
        for (const int v : panel.vertex) one.color.push_back(scale.color(mu[v]));
    }

    constexpr int bar_width = 400, bar_height = 14, bar_room = bar_height + 4 * margin;
    generate::FrontView view;
    view.width = width;
    view.metres_per_pixel = std::max(size.x(), 1e-9) / (width - 2 * margin);
    view.height = static_cast<int>(std::clamp(size.y() / view.metres_per_pixel, 1.0, 4000.0)) + 2 * margin + bar_room;
    view.centre << 0.5 * size.x(), view.metres_per_pixel * (margin - 0.5 * view.height);
    const int bar_left = (width - bar_width) / 2, bar_top = view.height - bar_room + margin;
    surface.push_back(color_bar(view.metres_per_pixel * Eigen::Vector2d(bar_left - margin, margin - bar_top),
                                view.metres_per_pixel * Eigen::Vector2d(bar_width, bar_height)));
    files::Picture picture = generate::render(surface, view);
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const std::string text = fmt::format("{:.2g}", std::exp(scale.low + share * (scale.high - scale.low)));
        const int x = bar_left + static_cast<int>(share * bar_width) - letter * static_cast<int>(text.size()) / 2;
        generate::write_text(picture, x, bar_top + bar_height + 6, text);
    }
    generate::write_text(picture, bar_left - 3 * letter, bar_top + 2, "mu");
    return picture;
}

std::string mu_alt_text(const Eigen::VectorXd& mu) {
    return fmt::format(
        "Stiffness mu of the target springs at each vertex, on the flat pattern: from {:.2g} (purple) to {:.2g} "
        "(yellow), median {:.2g}, half of the vertices between {:.2g} and {:.2g}.",
        mu.minCoeff(), mu.maxCoeff(), quantile(mu, 0.5), quantile(mu, 0.25), quantile(mu, 0.75));
}

ReportPicture mu_block(const ClothMesh& mesh, const Eigen::VectorXd& mu, const std::string& id) {
    return {id, "\u03bc over the garment", mu_alt_text(mu),
            "data:image/png;base64," + files::base64(files::png_bytes(mu_picture(mesh, mu)))};
}

std::optional<ReportPicture> learned_mu_block(const std::string& accuracy_file) {
    const files::Hdf5File file = files::Hdf5File::open(accuracy_file);
    if (!file.has("/mu/vertex")) return std::nullopt;
    const ClothMesh mesh = files::read_mesh_group(file);
    const std::vector<double> mu = file.read<double>("/mu/vertex", {mesh.vertex_count()}).value;
    return mu_block(mesh, Eigen::Map<const Eigen::VectorXd>(mu.data(), mesh.vertex_count()), "accuracy-mu");
}

}  // namespace toile::evaluate

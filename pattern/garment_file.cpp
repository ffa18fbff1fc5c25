#include "pattern/garment_file.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/push_out.h"
#include "pattern/refine.h"
#include "pattern/texture_pattern.h"
#include "pattern/weld.h"
#include "pattern/winding.h"
#include "skin/surface_query.h"

namespace toile::pattern {
namespace {

constexpr double weld_share = 1e-3;  // of the median edge

void check_range(const char* name, double value, double low, double high, const std::string& where) {
    if (value >= low && value <= high) return;
    std::ostringstream text;
    text << "garment option " << name << " is " << value << "; allowed are " << low << " to " << high;
    throw Error(text.str(), where);
}

void check_options(const GarmentFileOptions& options, const std::string& where) {
    check_range("unit_scale", options.unit_scale, 1e-6, 1000.0, where);
    check_range("pattern_scale", options.pattern_scale, 0.0, 1000.0, where);
    check_range("clearance", options.clearance, 0.0, 0.02, where);
    check_range("max_push", options.max_push, 0.0, 0.1, where);
    if (options.edge_length != 0.0) check_range("edge_length", options.edge_length, 0.004, 1.0, where);
}

void check_mesh(const files::MeshData& mesh, const std::string& where) {
    const auto vertex = [](long v) { return "vertex " + std::to_string(v); };
    if (mesh.triangle.rows() == 0) throw Error("the garment has no triangles", where);
    if (mesh.texture.rows() == 0)
        throw Error("the garment has no texture coordinates", where,
                    "they are its pattern: unwrap each panel to its cut and export the coordinates (vt)");
    if (mesh.texture.rows() != mesh.position.rows())
        throw Error("the garment has " + std::to_string(mesh.position.rows()) + " vertices but " +
                        std::to_string(mesh.texture.rows()) + " texture coordinates",
                    where);
    for (int v = 0; v < mesh.position.rows(); ++v) {
        if (!mesh.position.row(v).allFinite()) throw Error(vertex(v) + " is not finite", where);
        if (!mesh.texture.row(v).allFinite())
            throw Error("the texture coordinates of " + vertex(v) + " are not finite", where);
    }
    std::vector<bool> used(static_cast<size_t>(mesh.position.rows()), false);
    for (int f = 0; f < mesh.triangle.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int v = mesh.triangle(f, k);
            if (v < 0 || v >= mesh.position.rows())
                throw Error("triangle " + std::to_string(f) + " refers to " + vertex(v) + " of " +
                                std::to_string(mesh.position.rows()),
                            where);
            used[v] = true;
        }
    }
    for (size_t v = 0; v < used.size(); ++v)
        if (!used[v])
            throw Error(vertex(static_cast<long>(v)) + " belongs to no triangle", where, "delete loose vertices");
}

/// Metres, y up: x up is turned about z, z up about x (so that -y of the file becomes the front).
Positions upright(const files::MeshData& mesh, const GarmentFileOptions& options) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (options.up == UpAxis::x) turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    if (options.up == UpAxis::z) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return options.unit_scale * mesh.position * turn.transpose();
}

/// The sewn connectivity, and texture coordinates by triangle corner.
struct Sewn {
    Triangles triangle;
    Positions position;
    PlanePositions corner_texture;
};

Sewn sew_by_position(const files::MeshData& mesh, const Positions& position, const std::string& where,
                     std::vector<std::string>& remarks) {
    Sewn sewn;
    int count = 0;
    const double tolerance = weld_share * median_edge(mesh.triangle, position);
    const std::vector<int> vertex = weld_positions(position, tolerance, count);
    sewn.position.resize(count, 3);
    for (int v = static_cast<int>(vertex.size()) - 1; v >= 0; --v) sewn.position.row(vertex[v]) = position.row(v);
    sewn.triangle = mesh.triangle.unaryExpr([&](int v) { return vertex[v]; });
    sewn.corner_texture.resize(3 * mesh.triangle.rows(), 2);
    for (int f = 0; f < mesh.triangle.rows(); ++f) {
        const auto t = sewn.triangle.row(f);
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            throw Error("triangle " + std::to_string(f) + " has no area: two of its corners are in one place", where);
        for (int k = 0; k < 3; ++k) sewn.corner_texture.row(3 * f + k) = mesh.texture.row(mesh.triangle(f, k));
    }
    const long doubled = position.rows() - count;
    if (doubled > 0)
        remarks.push_back(std::to_string(doubled) + " vertices repeated along seams were welded, " +
                          std::to_string(count) + " are left");
    return sewn;
}

void wind(Sewn& sewn, const skin::SurfaceQuery* body, const std::string& where, std::vector<std::string>& remarks) {
    const std::vector<bool> turn = triangles_to_turn(sewn.triangle, sewn.position, body, where);
    int turned = 0;
    for (int f = 0; f < sewn.triangle.rows(); ++f) {
        if (!turn[f]) continue;
        ++turned;
        std::swap(sewn.triangle(f, 1), sewn.triangle(f, 2));
        sewn.corner_texture.row(3 * f + 1).swap(sewn.corner_texture.row(3 * f + 2));
    }
    if (turned > 0)
        remarks.push_back(std::to_string(turned) + " of " + std::to_string(sewn.triangle.rows()) +
                          " triangles were turned over to face outwards");
}

/// A panel's name: that of the file's part its first triangle came from, unless another panel has it.
std::vector<std::string> name_panels(const files::MeshData& mesh, const std::vector<int>& triangle_panel) {
    std::vector<std::string> name;
    for (size_t f = 0; f < triangle_panel.size(); ++f) {
        const size_t panel = static_cast<size_t>(triangle_panel[f]);
        if (panel < name.size() && !name[panel].empty()) continue;
        name.resize(std::max(name.size(), panel + 1));
        std::string wanted;
        if (f < mesh.part.size() && mesh.part[f] >= 0 && mesh.part[f] < static_cast<int>(mesh.part_name.size()))
            wanted = mesh.part_name[mesh.part[f]];
        bool taken = wanted.empty();
        for (const std::string& other : name) taken = taken || other == wanted;
        name[panel] = taken ? "panel " + std::to_string(panel) : wanted;
    }
    return name;
}

std::string describe(const PushOutReport& report, double clearance) {
    std::ostringstream text;
    text.precision(2);
    text << report.inside << " vertices were inside the body, the deepest by " << 1000.0 * report.deepest << " mm; "
         << report.moved << " were moved to keep " << 1000.0 * clearance << " mm";
    if (report.still_near > 0) text << ", " << report.still_near << " are still nearer than half of that";
    return text.str();
}

}  // namespace

Garment garment_from_mesh(const files::MeshData& mesh, const GarmentFileOptions& options, const skin::Body* body,
                          const std::string& where) {
    check_options(options, where);
    check_mesh(mesh, where);
    std::unique_ptr<skin::SurfaceQuery> surface;
    if (body) surface = std::make_unique<skin::SurfaceQuery>(body->triangle, body->rest_position);

    Garment garment;
    Sewn sewn = sew_by_position(mesh, upright(mesh, options), where, garment.remarks);
    wind(sewn, surface.get(), where, garment.remarks);
    TexturePattern pattern =
        panels_from_texture(sewn.triangle, sewn.position, sewn.corner_texture, options.pattern_scale, where);
    garment.remarks.insert(garment.remarks.end(), pattern.remarks.begin(), pattern.remarks.end());
    garment.triangle_panel = pattern.triangle_panel;
    garment.panel_name = name_panels(mesh, pattern.triangle_panel);
    garment.mesh.triangle = sewn.triangle;
    garment.mesh.rest_position = sewn.position;
    garment.mesh.pattern_position = pattern.position;
    garment.mesh.pattern_triangle = pattern.triangle;
    check_cloth_mesh(garment.mesh, where);

    if (options.edge_length > 0.0) {
        const int before = garment.mesh.vertex_count();
        refine(garment, options.edge_length);
        garment.remarks.push_back("refined from " + std::to_string(before) + " to " +
                                  std::to_string(garment.mesh.vertex_count()) + " vertices");
    }
    if (surface) {
        const PushOutReport report = push_out(garment.mesh.triangle, garment.mesh.rest_position, *surface,
                                              {.clearance = options.clearance, .max_push = options.max_push}, where);
        if (report.moved > 0) garment.remarks.push_back(describe(report, options.clearance));
        check_cloth_mesh(garment.mesh, where);
    }
    return garment;
}

Garment read_garment(const std::string& path, const GarmentFileOptions& options, const skin::Body* body) {
    return garment_from_mesh(files::read_mesh(path), options, body, path);
}

}  // namespace toile::pattern

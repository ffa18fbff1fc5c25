#include "skin/joined_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "skin/hole_filling.h"

namespace toile::skin {
namespace {

using Influences = std::vector<std::pair<int, double>>;  // joint, value; heaviest first

constexpr double sum_tolerance = 0.002;    // what three-digit text and half floats round off
constexpr double weld_tolerance = 1e-6;    // of the body's size: what floats round off where meshes are placed apart
constexpr double weight_tolerance = 1e-3;  // between the weights of vertices of two meshes that are to be one

bool nearly_equal(const Influences& a, const Influences& b) {
    if (a.size() != b.size()) return false;
    for (const auto& [joint, value] : a) {
        const auto same = std::find_if(b.begin(), b.end(), [j = joint](const auto& other) { return other.first == j; });
        if (same == b.end() || std::abs(same->second - value) > weight_tolerance) return false;
    }
    return true;
}

/// Points by the cell they lie in, for finding those within a cell's width.
struct CellIndex {
    double width;
    std::map<std::array<long long, 3>, std::vector<int>> in_cell;

    std::array<long long, 3> cell(const Eigen::Vector3d& p) const {
        return {std::llround(p.x() / width), std::llround(p.y() / width), std::llround(p.z() / width)};
    }
    void add(const Eigen::Vector3d& p, int index) { in_cell[cell(p)].push_back(index); }
    std::vector<int> near(const Eigen::Vector3d& p) const {
        std::vector<int> found;
        for (int k = 0; k < 8; ++k) {
            const Eigen::Vector3d corner =
                p + 0.25 * width * Eigen::Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
            const auto entry = in_cell.find(cell(corner));
            if (entry != in_cell.end()) found.insert(found.end(), entry->second.begin(), entry->second.end());
        }
        return found;
    }
};

/// The surface as it grows, with an index for welding.
struct SurfaceBuilder {
    const files::RiggedFile& file;
    const BindSkeleton& skeleton;
    const std::string& where;
    CellIndex cells;
    std::vector<Eigen::Vector3d> position;
    std::vector<int> mesh_of;  // the mesh each joined vertex came from
    std::vector<Influences> influence;
    std::vector<std::array<int, 3>> triangle;
    int collapsed = 0, welded = 0, unused = 0;

    Influences influences_of(const files::RiggedMesh& mesh, int v) const {
        std::map<int, double> by_joint;
        double sum = 0;
        const std::string name = "vertex " + std::to_string(v) + " of mesh '" + mesh.name + "'";
        for (int i = mesh.influence_offset[v]; i < mesh.influence_offset[v + 1]; ++i) {
            const double value = mesh.influence_value[i];
            if (value < 0) throw Error("the weight " + std::to_string(value) + " of " + name + " is negative", where);
            if (value == 0) continue;
            by_joint[skeleton.joint_of_node[mesh.bone[mesh.influence_bone[i]].node]] += value;
            sum += value;
        }
        if (by_joint.empty())
            throw Error(name + " hangs on no joint", where, "give every vertex a weight (unskinned parts left out)");
        // Integers round each weight by up to half a step.
        const double rounded = 0.5 * mesh.weight_step * (mesh.influence_offset[v + 1] - mesh.influence_offset[v]);
        if (!(std::abs(sum - 1) <= std::max(sum_tolerance, 1.001 * rounded)))
            throw Error("the weights of " + name + " sum to " + std::to_string(sum), where, "normalise the weights");
        Influences influences(by_joint.begin(), by_joint.end());
        for (auto& entry : influences) entry.second /= sum;
        std::stable_sort(influences.begin(), influences.end(),
                         [](const auto& a, const auto& b) { return a.second > b.second; });
        return influences;
    }

    /// The vertex in bind space: carried by the mesh's placement, or skinned there where the bones' placements differ.
    Eigen::Vector3d placed(const files::RiggedMesh& mesh, const std::vector<Eigen::Affine3d>& placement, int v) const {
        const Eigen::Vector3d stored = mesh.position.row(v).transpose();
        const int first = mesh.influence_offset[v], last = mesh.influence_offset[v + 1];
        Eigen::Vector3d blend = Eigen::Vector3d::Zero();
        double sum = 0;
        bool differs = false;
        for (int i = first; i < last; ++i) {
            const Eigen::Affine3d& by_bone = placement[mesh.influence_bone[i]];
            differs = differs || by_bone.matrix() != placement[mesh.influence_bone[first]].matrix();
            blend += mesh.influence_value[i] * (by_bone * stored);
            sum += mesh.influence_value[i];
        }
        return differs ? Eigen::Vector3d(blend / sum) : placement[mesh.influence_bone[first]] * stored;
    }

    /// Vertices keep the file's order.
    void add(int mesh_index, const std::vector<Eigen::Affine3d>& placement) {
        const files::RiggedMesh& mesh = file.mesh[mesh_index];
        std::vector<bool> used(static_cast<size_t>(mesh.position.rows()), false);
        for (int i = 0; i < mesh.triangle.size(); ++i) used[mesh.triangle.data()[i]] = true;
        std::vector<int> index(used.size(), -1);
        for (size_t v = 0; v < used.size(); ++v)
            if (used[v]) index[v] = vertex(mesh, mesh_index, placement, static_cast<int>(v));
        for (int f = 0; f < mesh.triangle.rows(); ++f) {
            const std::array<int, 3> corners = {index[mesh.triangle(f, 0)], index[mesh.triangle(f, 1)],
                                                index[mesh.triangle(f, 2)]};
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
                ++collapsed;
            else
                triangle.push_back(corners);
        }
        unused += static_cast<int>(std::count(used.begin(), used.end(), false));
    }

    /// Within a mesh what is the same vertex has the same bits; between meshes rounding is allowed for.
    int vertex(const files::RiggedMesh& mesh, int mesh_index, const std::vector<Eigen::Affine3d>& placement, int v) {
        Influences influences = influences_of(mesh, v);
        const Eigen::Vector3d p = placed(mesh, placement, v);
        for (const int other : cells.near(p)) {
            const bool same = mesh_of[other] == mesh_index ? position[other] == p && influence[other] == influences
                                                           : (position[other] - p).norm() <= 0.25 * cells.width &&
                                                                 nearly_equal(influence[other], influences);
            if (!same) continue;
            ++welded;
            return other;
        }
        const int fresh = static_cast<int>(position.size());
        cells.add(p, fresh);
        position.push_back(p);
        influence.push_back(std::move(influences));
        mesh_of.push_back(mesh_index);
        return fresh;
    }
};

void fill(const SurfaceBuilder& builder, JoinedSurface& out) {
    out.position.resize(static_cast<long>(builder.position.size()), 3);
    out.weight.offset.assign(1, 0);
    for (size_t v = 0; v < builder.position.size(); ++v) {
        out.position.row(static_cast<long>(v)) = builder.position[v].transpose();
        for (const auto& [joint, value] : builder.influence[v]) {
            out.weight.joint.push_back(joint);
            out.weight.value.push_back(value);
        }
        out.weight.offset.push_back(static_cast<int>(out.weight.joint.size()));
    }
    out.triangle.resize(static_cast<long>(builder.triangle.size()), 3);
    for (size_t f = 0; f < builder.triangle.size(); ++f)
        out.triangle.row(static_cast<long>(f)) << builder.triangle[f][0], builder.triangle[f][1],
            builder.triangle[f][2];
}

double signed_volume(const JoinedSurface& surface) {
    const Eigen::RowVector3d center = surface.position.colwise().mean();
    double volume = 0;
    for (int f = 0; f < surface.triangle.rows(); ++f) {
        const Eigen::RowVector3d a = surface.position.row(surface.triangle(f, 0)) - center;
        const Eigen::RowVector3d b = surface.position.row(surface.triangle(f, 1)) - center;
        const Eigen::RowVector3d c = surface.position.row(surface.triangle(f, 2)) - center;
        volume += a.dot(b.cross(c)) / 6;
    }
    return volume;
}

/// A body must have an inside: what covers no clothing (mouths, eyes, a neck without a head) is often left open.
void close_holes(JoinedSurface& surface) {
    const long before = surface.triangle.rows();
    FilledHoles closed = fill_holes(surface.triangle, surface.position);
    surface.triangle = std::move(closed.triangle);
    if (closed.filled > 0)
        surface.remarks.push_back(std::to_string(closed.filled) + " holes of the surface were closed with " +
                                  std::to_string(surface.triangle.rows() - before) + " triangles");
    const Topology topology = build_topology(surface.triangle);
    const long open = (topology.edge_triangle.col(1).array() < 0).count();
    if (open > 0)
        surface.remarks.push_back("the surface is not closed: it has " + std::to_string(open) + " open edges");
    if (topology.non_manifold_edge >= 0)
        surface.remarks.push_back("some edges of the surface belong to more than two triangles");
}

/// The extent of the skeleton in bind space.
double size(const BindSkeleton& skeleton) {
    Eigen::AlignedBox3d box;
    for (const auto& joint : skeleton.joint) box.extend(Eigen::Vector3d(joint.bind.translation()));
    return std::max(box.diagonal().norm(), 1e-12);
}

}  // namespace

JoinedSurface join_surface(const files::RiggedFile& file, const std::vector<int>& mesh, const BindSkeleton& skeleton,
                           const std::string& where) {
    SurfaceBuilder builder{file, skeleton, where, {4 * weld_tolerance * size(skeleton), {}}, {}, {}, {}, {}};
    for (size_t m = 0; m < mesh.size(); ++m) builder.add(mesh[m], skeleton.placement[m]);
    if (builder.triangle.empty()) throw Error("the body has no faces", where);
    JoinedSurface out;
    fill(builder, out);
    if (builder.welded > 0)
        out.remarks.push_back(std::to_string(builder.welded) + " vertices repeated along seams were welded");
    if (builder.collapsed > 0)
        out.remarks.push_back(std::to_string(builder.collapsed) + " triangles without extent were dropped");
    if (builder.unused > 0)
        out.remarks.push_back(std::to_string(builder.unused) + " vertices without a triangle were dropped");
    if (signed_volume(out) < 0) {
        out.triangle.col(1).swap(out.triangle.col(2));
        out.remarks.push_back("the surface was inside out and has been turned");
    }
    close_holes(out);
    return out;
}

}  // namespace toile::skin

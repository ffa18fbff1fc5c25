#include "skin/bind_skeleton.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <optional>

#include "cloth/error.h"

namespace toile::skin {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;
using files::RiggedBone;
using files::RiggedFile;

double scale_of(const Affine3d& transform) {
    return std::cbrt(std::abs(transform.linear().determinant()));
}

Affine3d inverse_offset(const RiggedBone& bone, const std::string& where) {
    const double determinant = bone.offset.topLeftCorner<3, 3>().determinant();
    const double size = std::pow(bone.offset.topLeftCorner<3, 3>().norm(), 3);
    if (!bone.offset.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-5) || !(std::abs(determinant) > 1e-9 * size))
        throw Error("the bind matrix of joint '" + bone.name + "' cannot be inverted", where);
    if (determinant < 0)
        throw Error("the bind matrix of joint '" + bone.name + "' mirrors", where,
                    "apply the armature's scale before exporting");
    return Affine3d(bone.offset).inverse();
}

Affine3d local_of(const RiggedFile& file, int node) {
    return Affine3d(file.node[node].local);
}

Affine3d scene_transform(const RiggedFile& file, int node) {
    Affine3d transform = Affine3d::Identity();
    for (; node >= 0; node = file.node[node].parent) transform = local_of(file, node) * transform;
    return transform;
}

/// Bind transforms by node, as the meshes are placed one after the other.
struct BindBuilder {
    const RiggedFile& file;
    const std::vector<int>& mesh;
    const std::string& where;
    std::vector<std::optional<Affine3d>> bind;  // [nodes]
    std::vector<bool> named;                    // [nodes] named by a skin
    BindSkeleton out;

    /// The next mesh to place: one that shares a joint with those placed before, if there is one.
    size_t next_mesh(const std::vector<bool>& placed) const {
        size_t first = mesh.size();
        for (size_t m = 0; m < mesh.size(); ++m) {
            if (placed[m]) continue;
            if (first == mesh.size()) first = m;
            for (const RiggedBone& bone : file.mesh[mesh[m]].bone)
                if (bind[bone.node]) return m;
        }
        return first;
    }

    /// Where a mesh without a joint in common with the others goes: by the scene, in its default pose.
    Affine3d placement_by_scene(const RiggedBone& bone, bool is_first) {
        if (is_first) return Affine3d::Identity();
        return out.scene.inverse() * scene_transform(file, bone.node) * Affine3d(bone.offset);
    }

    void place(size_t m, bool is_first) {
        const files::RiggedMesh& data = file.mesh[mesh[m]];
        std::vector<Affine3d>& placement = out.placement[m];
        placement.resize(data.bone.size());
        std::optional<Affine3d> common;
        for (size_t b = 0; b < data.bone.size(); ++b) {
            inverse_offset(data.bone[b], where);
            const auto& known = bind[data.bone[b].node];
            if (!known) continue;
            placement[b] = *known * Affine3d(data.bone[b].offset);
            if (!common) common = placement[b];
        }
        if (!common) common = placement_by_scene(data.bone[0], is_first);
        bool differs = false;
        for (size_t b = 0; b < data.bone.size(); ++b) {
            auto& known = bind[data.bone[b].node];
            if (known) {
                differs = differs || !placement[b].isApprox(*common, 1e-4);
                if (placement[b].isApprox(*common, 1e-6)) placement[b] = *common;  // rounding of the file's floats
                continue;
            }
            known = *common * inverse_offset(data.bone[b], where);
            placement[b] = *common;
        }
        if (differs)
            out.remarks.push_back("mesh '" + data.name + "' was bound in another pose than '" +
                                  file.mesh[mesh[0]].name + "': it was posed to fit");
    }

    void place_meshes() {
        std::vector<bool> placed(mesh.size(), false);
        out.placement.resize(mesh.size());
        for (size_t count = 0; count < mesh.size(); ++count) {
            const size_t m = next_mesh(placed);
            place(m, count == 0);
            placed[m] = true;
            if (count == 0) {
                const int top = topmost(file.mesh[mesh[m]]);
                out.scene = scene_transform(file, top) * bind[top]->inverse();
            }
        }
        for (size_t n = 0; n < bind.size(); ++n) named[n] = bind[n].has_value();
    }

    /// The joint of a mesh that comes first in the tree: nodes are listed with parents first.
    static int topmost(const files::RiggedMesh& data) {
        int top = data.bone[0].node;
        for (const RiggedBone& bone : data.bone) top = std::min(top, bone.node);
        return top;
    }

    /// Marks what belongs to the skeleton: named joints and the nodes that lead from one to another.
    std::vector<bool> skeleton_nodes() const {
        std::vector<int> below(bind.size(), 0);  // named joints in each subtree
        int all = 0;
        for (size_t n = bind.size(); n-- > 0;) {
            below[n] += named[n];
            all += named[n];
            if (file.node[n].parent >= 0) below[file.node[n].parent] += below[n];
        }
        std::vector<bool> inside(bind.size(), false);
        bool found_top = false;
        for (size_t n = 0; n < bind.size(); ++n) {
            if (below[n] == 0) continue;
            // The root is the deepest node that has all joints below it, or the first that is one.
            bool narrows = named[n];
            if (!found_top && !narrows) {
                narrows = true;
                for (size_t c = n + 1; c < bind.size(); ++c)
                    if (file.node[c].parent == static_cast<int>(n) && below[c] == all) narrows = false;
            }
            found_top = found_top || narrows;
            inside[n] = found_top;
        }
        return inside;
    }

    Affine3d fitted(int node, const std::vector<bool>& inside) const;
    void fit_unnamed(const std::vector<bool>& inside);
};

/// Weighted points to carry over: where they are in a joint's frame, and where they belong.
struct PointPairs {
    std::vector<Vector3d> from, to;
    std::vector<double> weight;

    void add(const Vector3d& source, const Vector3d& target, double w) {
        from.push_back(source);
        to.push_back(target);
        weight.push_back(w);
    }

    /// The rotation and translation, at the given scale, that carry `from` to `to` best.
    Affine3d fit(double scale) const {
        Vector3d from_mean = Vector3d::Zero(), to_mean = Vector3d::Zero();
        double sum = 0;
        for (size_t i = 0; i < from.size(); ++i) {
            from_mean += weight[i] * from[i];
            to_mean += weight[i] * to[i];
            sum += weight[i];
        }
        from_mean /= sum;
        to_mean /= sum;
        Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
        for (size_t i = 0; i < from.size(); ++i)
            covariance += weight[i] * (to[i] - to_mean) * (from[i] - from_mean).transpose();
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d proper = Eigen::Matrix3d::Identity();
        proper(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
        Affine3d fit = Affine3d::Identity();
        fit.linear() = scale * svd.matrixU() * proper * svd.matrixV().transpose();
        fit.translation() = to_mean - fit.linear() * from_mean;
        return fit;
    }
};

/// Bone lengths hold in every pose, so neighbours' origins weigh much; the rotations of the default pose weigh little,
/// and settle what the origins leave open.
Affine3d BindBuilder::fitted(int node, const std::vector<bool>& inside) const {
    constexpr double firm = 1, loose = 1e-7;
    PointPairs pairs;
    double scale = 0;
    auto lean_on = [&](const Affine3d& guess, const Vector3d& origin) {
        if (scale == 0) scale = scale_of(guess);
        const double reach = std::max(origin.norm(), 1e-3);
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-reach, reach})
                pairs.add(sign * Vector3d::Unit(axis), guess * Vector3d(sign * Vector3d::Unit(axis)), loose);
    };
    const int parent = file.node[node].parent;
    if (parent >= 0 && bind[parent]) {
        const Affine3d guess = *bind[parent] * local_of(file, node);
        lean_on(guess, local_of(file, node).translation());
        pairs.add(Vector3d::Zero(), guess.translation(), firm);
    }
    for (size_t child = 0; child < bind.size(); ++child) {
        if (file.node[child].parent != node || !bind[child] || !inside[child]) continue;
        const Affine3d local = local_of(file, static_cast<int>(child));
        if (std::abs(local.linear().determinant()) > 1e-12)
            lean_on(*bind[child] * local.inverse(), local.translation());
        pairs.add(local.translation(), bind[child]->translation(), firm);
    }
    return pairs.fit(scale);
}

void BindBuilder::fit_unnamed(const std::vector<bool>& inside) {
    for (bool progress = true; progress;) {
        progress = false;
        for (size_t n = 0; n < bind.size(); ++n) {
            if (!inside[n] || bind[n]) continue;
            bool neighbour = file.node[n].parent >= 0 && bind[file.node[n].parent];
            for (size_t child = n + 1; child < bind.size() && !neighbour; ++child)
                neighbour = file.node[child].parent == static_cast<int>(n) && bind[child].has_value();
            if (!neighbour) continue;
            bind[n] = fitted(static_cast<int>(n), inside);
            progress = true;
        }
    }
}

/// Nodes of the skeleton in the order the skins list them, as far as parents come first; the others as in the tree.
std::vector<int> joint_order(const RiggedFile& file, const std::vector<int>& mesh, const std::vector<bool>& inside) {
    std::vector<int> listed, order, chain;
    for (const int m : mesh)
        for (const RiggedBone& bone : file.mesh[m].bone) listed.push_back(bone.node);
    for (size_t n = 0; n < file.node.size(); ++n) listed.push_back(static_cast<int>(n));
    std::vector<bool> placed(file.node.size(), false);
    for (const int n : listed) {
        for (int above = n; above >= 0 && inside[above] && !placed[above]; above = file.node[above].parent) {
            placed[above] = true;
            chain.push_back(above);
        }
        order.insert(order.end(), chain.rbegin(), chain.rend());
        chain.clear();
    }
    return order;
}

}  // namespace

BindSkeleton bind_skeleton(const RiggedFile& file, const std::vector<int>& mesh, const std::string& where) {
    const size_t nodes = file.node.size();
    BindBuilder builder{file, mesh, where, std::vector<std::optional<Affine3d>>(nodes), std::vector<bool>(nodes), {}};
    builder.place_meshes();
    const std::vector<bool> inside = builder.skeleton_nodes();
    builder.fit_unnamed(inside);
    BindSkeleton out = std::move(builder.out);
    out.joint_of_node.assign(nodes, -1);
    for (const int n : joint_order(file, mesh, inside)) {
        const int above = file.node[n].parent;
        out.joint_of_node[n] = static_cast<int>(out.joint.size());
        out.joint.push_back({n, above < 0 ? -1 : out.joint_of_node[above], *builder.bind[n]});
    }
    return out;
}

}  // namespace toile::skin

#include "skin/rigged_body.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <numeric>

#include "cloth/error.h"
#include "files/rigged_file.h"
#include "skin/bind_skeleton.h"
#include "skin/body_frame.h"
#include "skin/joined_surface.h"
#include "skin/role_names.h"

namespace toile::skin {
namespace {

/// Levenshtein's distance, blind to case.
int edit_distance(const std::string& a, const std::string& b) {
    std::vector<int> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (size_t i = 1; i <= a.size(); ++i) {
        int diagonal = row[0];
        row[0] = static_cast<int>(i);
        for (size_t k = 1; k <= b.size(); ++k) {
            const bool same = std::tolower(static_cast<unsigned char>(a[i - 1])) ==
                              std::tolower(static_cast<unsigned char>(b[k - 1]));
            const int change = diagonal + (same ? 0 : 1);
            diagonal = row[k];
            row[k] = std::min({change, row[k] + 1, row[k - 1] + 1});
        }
    }
    return row[b.size()];
}

std::string nearest_names(const std::string& wanted, std::vector<std::string> names) {
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
        return edit_distance(wanted, a) < edit_distance(wanted, b);
    });
    std::string list;
    for (size_t i = 0; i < std::min<size_t>(3, names.size()); ++i) list += (i ? ", " : "") + names[i];
    return list;
}

std::vector<int> chosen_meshes(const files::RiggedFile& file, const RiggedBodyOptions& options, const std::string& path,
                               std::vector<std::string>& remarks) {
    std::vector<int> chosen;
    std::vector<std::string> names;
    for (const files::RiggedMesh& mesh : file.mesh)
        if (!mesh.bone.empty()) names.push_back(mesh.name);
    for (const std::string& wanted : options.mesh)
        if (std::find(names.begin(), names.end(), wanted) == names.end())
            throw Error("the file has no skinned mesh '" + wanted + "'", path,
                        "near it: " + nearest_names(wanted, names));
    for (size_t m = 0; m < file.mesh.size(); ++m) {
        const files::RiggedMesh& mesh = file.mesh[m];
        const bool wanted = options.mesh.empty() ||
                            std::find(options.mesh.begin(), options.mesh.end(), mesh.name) != options.mesh.end();
        if (wanted && !mesh.bone.empty())
            chosen.push_back(static_cast<int>(m));
        else if (wanted)
            remarks.push_back("mesh '" + mesh.name + "' has no skin and was left out");
    }
    return chosen;
}

std::vector<NamedJoint> joint_names(const files::RiggedFile& file, const BindSkeleton& skeleton) {
    std::vector<NamedJoint> names;
    for (const auto& joint : skeleton.joint) names.push_back({file.node[joint.node].name, joint.parent});
    return names;
}

RoleMap given_roles(const std::vector<NamedJoint>& joint, const RiggedBodyOptions& options, const std::string& path) {
    RoleMap roles;
    std::vector<std::string> names;
    for (const NamedJoint& each : joint) names.push_back(each.name);
    for (const auto& [role, name] : options.role) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw Error("the role " + std::string(role_name(role)) + " is given to the joint '" + name +
                            "', which the body does not have",
                        path, "near it: " + nearest_names(name, names));
        roles[role] = static_cast<int>(found - names.begin());
    }
    return roles;
}

/// The bind transform in the body's frame without its scale: the nearest rotation.
Eigen::Matrix4d rigid_bind(const Eigen::Affine3d& bind, const BodyFrame& frame) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(frame.rotation * bind.linear(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix4d rigid = Eigen::Matrix4d::Identity();
    rigid.topLeftCorner<3, 3>() = svd.matrixU() * svd.matrixV().transpose();
    rigid.topRightCorner<3, 1>() = frame.metres_per_unit * (frame.rotation * bind.translation());
    return rigid;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

RiggedBody read_rigged_body(const std::string& path, const RiggedBodyOptions& options) {
    const files::RiggedFile file = files::read_rigged_file(path);
    RiggedBody out;
    const std::vector<int> mesh = chosen_meshes(file, options, path, out.remarks);
    const BindSkeleton skeleton = bind_skeleton(file, mesh, path);
    JoinedSurface surface = join_surface(file, mesh, skeleton, path);
    const std::vector<NamedJoint> names = joint_names(file, skeleton);
    const RoleMap role = detect_roles(names, given_roles(names, options, path));
    const BodyFrame frame =
        body_frame(file, skeleton, role, surface.position, options.up, options.metres_per_unit, path);

    Body& body = out.body;
    body.rest_position = frame.metres_per_unit * (surface.position * frame.rotation.transpose());
    body.triangle = std::move(surface.triangle);
    body.weight = std::move(surface.weight);
    body.role = role;
    for (size_t j = 0; j < names.size(); ++j)
        body.joint.push_back({names[j].name, names[j].parent, rigid_bind(skeleton.joint[j].bind, frame)});
    append(out.remarks, skeleton.remarks);
    append(out.remarks, surface.remarks);
    append(out.remarks, frame.remarks);
    std::string missing;
    for (const Role absent : role.missing()) missing += (missing.empty() ? "" : ", ") + std::string(role_name(absent));
    if (!missing.empty()) out.remarks.push_back("no joint was found for the roles " + missing);
    check_body(body, path);
    return out;
}

}  // namespace toile::skin

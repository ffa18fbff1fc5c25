#include "skin/pose_table.h"

#include <array>
#include <map>
#include <optional>
#include <string_view>

#include "cloth/error.h"
#include "files/table_file.h"
#include "skin/anatomy.h"

namespace toile::skin {
namespace {

/// Where a column's value goes.
struct Column {
    int joint;                 ///< of the body
    std::optional<Role> role;  ///< set for an anatomical angle
    int axis;                  ///< x, y, z or raise, swing, twist
};

std::optional<Role> find_role(std::string_view name) {
    for (int i = 0; i < role_count; ++i)
        if (role_name(static_cast<Role>(i)) == name) return static_cast<Role>(i);
    return {};
}

int find_joint(const Body& body, std::string_view name) {
    for (int j = 0; j < body.joint_count(); ++j)
        if (body.joint[j].name == name) return j;
    const std::optional<Role> role = find_role(name);
    return role ? body.role[*role] : -1;
}

int find_axis(std::string_view name, const std::array<std::string_view, 3>& axes) {
    for (int axis = 0; axis < 3; ++axis)
        if (axes[axis] == name) return axis;
    return -1;
}

Column to_column(const Body& body, const std::string& name, const std::string& where) {
    // Joint names may hold dots themselves.
    const std::size_t dot = name.rfind('.');
    const std::string_view joint = std::string_view(name).substr(0, dot);
    const std::string_view axis = dot == std::string::npos ? "" : std::string_view(name).substr(dot + 1);
    Column column{-1, {}, find_axis(axis, {"x", "y", "z"})};
    if (column.axis >= 0) {
        column.joint = find_joint(body, joint);
    } else {
        column.axis = find_axis(axis, {"raise", "swing", "twist"});
        column.role = find_role(joint);
        if (column.role) column.joint = body.role[*column.role];
    }
    if (column.axis < 0 || (column.joint < 0 && axis.size() > 1 && !column.role))
        throw Error("unknown column '" + name + "'", where,
                    "columns are <joint or role>.x, .y, .z or <role>.raise, .swing, .twist");
    if (column.joint < 0)
        throw Error("the body has no joint for the column '" + name + "'", where,
                    "check the name, or name the joint in the role map");
    return column;
}

/// One column for each value of the table.
std::vector<Column> to_columns(const Body& body, const files::Table& table) {
    std::vector<Column> column;
    if (table.column.empty()) {
        if (table.value.cols() != 3 * body.joint_count())
            throw Error("the table has " + std::to_string(table.value.cols()) + " values a row, but the body's " +
                            std::to_string(body.joint_count()) + " joints need " +
                            std::to_string(3 * body.joint_count()),
                        table.where_columns());
        for (int i = 0; i < table.value.cols(); ++i) column.push_back({i / 3, {}, i % 3});
        return column;
    }
    std::map<std::pair<int, int>, const std::string*> given;
    std::map<int, std::optional<Role>> kind;
    for (const std::string& name : table.column) {
        column.push_back(to_column(body, name, table.where_columns()));
        const Column& c = column.back();
        const auto [other, first] = given.emplace(std::pair(c.joint, c.axis), &name);
        if (!first || kind.emplace(c.joint, c.role).first->second != c.role)
            throw Error("the column '" + name + "' gives joint '" + body.joint[c.joint].name + "' a second time",
                        table.where_columns());
    }
    return column;
}

/// Axis-angle rotations mean nothing on a joint with other axes.
void check_bind(const Body& body, const files::Table& table, const std::vector<Column>& column) {
    for (std::size_t j = 0; j < table.joint_bind.size(); ++j) {
        const Joint& joint = body.joint[column[3 * j].joint];
        const Eigen::Matrix3d turn = joint.bind.topLeftCorner<3, 3>() - table.joint_bind[j].topLeftCorner<3, 3>();
        if (!(turn.cwiseAbs().maxCoeff() < 1e-3))
            throw Error("the dataset's joint '" + joint.name + "' has other axes than the body's: another body made it",
                        table.path + ":/body/joint_bind");
    }
}

}  // namespace

PoseList read_pose_table(const Body& body, const std::string& path) {
    const files::Table table = files::read_table(path);
    const std::vector<Column> column = to_columns(body, table);
    check_bind(body, table, column);
    RoleAngles bind;
    for (const Column& c : column)
        if (c.role) bind.angle[*c.role] = bind_angles(body, *c.role);

    std::vector<Pose> pose;
    pose.reserve(static_cast<std::size_t>(table.value.rows()));
    for (Eigen::Index row = 0; row < table.value.rows(); ++row) {
        RoleAngles angles = bind;
        for (std::size_t i = 0; i < column.size(); ++i)
            if (column[i].role) angles.angle[*column[i].role][column[i].axis] = table.value(row, i);
        pose.push_back(pose_from_angles(body, angles));
        // A joint with a column of its own follows the table alone, even a clavicle that would go along with its arm.
        for (const Column& c : column)
            if (!c.role) pose.back().row(c.joint).setZero();
        for (std::size_t i = 0; i < column.size(); ++i)
            if (!column[i].role) pose.back()(column[i].joint, column[i].axis) = table.value(row, i);
    }
    return PoseList(std::move(pose));
}

}  // namespace toile::skin

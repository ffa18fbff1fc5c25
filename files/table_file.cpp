#include "files/table_file.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "cloth/error.h"
#include "files/hdf5_file.h"

namespace toile::files {
namespace {

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    text = text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return text;
}

/// Text from the file, fit for a message.
std::string shown(std::string_view word) {
    std::string text = "'";
    for (const char c : word.substr(0, 40)) text += c >= ' ' && c < 127 ? c : '?';
    return text + "'";
}

std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> cell;
    for (std::size_t begin = 0;;) {
        const std::size_t comma = line.find(',', begin);
        cell.push_back(trimmed(line.substr(begin, comma - begin)));
        if (comma == std::string_view::npos) return cell;
        begin = comma + 1;
    }
}

void check_columns(const std::vector<std::string>& column, const std::string& where) {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < column.size(); ++i) {
        if (column[i].empty()) throw Error("column " + std::to_string(i + 1) + " has no name", where);
        if (!seen.insert(column[i]).second) throw Error("two columns are named " + shown(column[i]), where);
    }
}

double finite_number(std::string_view word, const std::string& column, const std::string& where) {
    std::string_view digits = word;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double value = 0;
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end.ec != std::errc() || end.ptr != digits.data() + digits.size() || !std::isfinite(value))
        throw Error("the value of " + shown(column) + " should be a number, but is " + shown(word), where);
    return value;
}

void read_header(std::string_view line, Table& table, const std::string& where) {
    for (const std::string_view name : cells(line)) {
        // std::string's range constructor would take control bytes of a binary file for a name.
        for (const char c : name)
            if (static_cast<unsigned char>(c) < ' ') throw Error("neither a CSV table nor HDF5", where);
        table.column.emplace_back(name);
    }
    check_columns(table.column, where);
}

Table read_csv(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    Table table;
    table.path = path;
    std::vector<double> value;
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
        if (line == 1 && text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
        if (trimmed(text).empty() || trimmed(text).starts_with('#')) continue;
        const std::string where = path + ":" + std::to_string(line);
        if (table.column.empty()) {
            table.header_line = line;
            read_header(text, table, where);
            continue;
        }
        const std::vector<std::string_view> cell = cells(text);
        if (cell.size() != table.column.size())
            throw Error("the row has " + std::to_string(cell.size()) + " values, but there are " +
                            std::to_string(table.column.size()) + " columns",
                        where);
        for (std::size_t i = 0; i < cell.size(); ++i) value.push_back(finite_number(cell[i], table.column[i], where));
        table.line.push_back(line);
    }
    if (table.column.empty()) throw Error("the table is empty", path);
    if (table.line.empty()) throw Error("the table has a line of column names, but no row", path);
    table.value = Eigen::Map<decltype(table.value)>(value.data(), static_cast<Eigen::Index>(table.line.size()),
                                                    static_cast<Eigen::Index>(table.column.size()));
    return table;
}

/// Columns and bind transforms that a dataset of ours says its joint rotations belong to.
void read_joints(const Hdf5File& file, std::int64_t joints, Table& table) {
    if (!file.has("/body/joint_name")) return;
    const std::vector<std::string> name = file.read_strings("/body/joint_name");
    if (static_cast<std::int64_t>(name.size()) != joints)
        throw Error("/samples/pose has " + std::to_string(joints) + " joints, but " + std::to_string(name.size()) +
                        " are named",
                    table.path + ":/body/joint_name");
    for (const std::string& joint : name)
        for (const char* axis : {".x", ".y", ".z"}) table.column.push_back(joint + axis);
    if (!file.has("/body/joint_bind")) return;
    const Array<double> bind = file.read<double>("/body/joint_bind", {joints, 4, 4});
    for (std::int64_t j = 0; j < joints; ++j)
        table.joint_bind.emplace_back(
            Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(bind.value.data() + 16 * j));
}

Table read_hdf5(const std::string& path) {
    const Hdf5File file = Hdf5File::open(path);
    Table table;
    table.path = path;
    Array<double> pose;
    if (file.has("/samples/pose")) {
        table.dataset = "/samples/pose";
        pose = file.read<double>(table.dataset, {any_size, any_size, 3});
        read_joints(file, pose.shape[1], table);
    } else if (file.has("/pose")) {
        table.dataset = "/pose";
        pose = file.read<double>(table.dataset, {any_size, any_size});
        table.column = file.strings_attribute(table.dataset, "columns");
    } else {
        throw Error("there are no poses: neither /samples/pose nor /pose", path);
    }
    const auto rows = static_cast<Eigen::Index>(pose.shape[0]);
    if (rows == 0 || pose.value.empty()) throw Error("the table has no row", table.where_columns());
    table.value =
        Eigen::Map<decltype(table.value)>(pose.value.data(), rows, static_cast<Eigen::Index>(pose.value.size()) / rows);
    if (!table.column.empty() && static_cast<Eigen::Index>(table.column.size()) != table.value.cols())
        throw Error("there are " + std::to_string(table.value.cols()) + " values a row, but " +
                        std::to_string(table.column.size()) + " columns are named",
                    table.where_columns());
    check_columns(table.column, table.where_columns());
    for (Eigen::Index row = 0; row < rows; ++row)
        if (!table.value.row(row).allFinite()) throw Error("a value is not a finite number", table.where(row));
    return table;
}

}  // namespace

std::string Table::where(Eigen::Index row) const {
    if (!line.empty()) return path + ":" + std::to_string(line[static_cast<std::size_t>(row)]);
    return path + ":" + dataset + "[" + std::to_string(row) + "]";
}

std::string Table::where_columns() const {
    return path + ":" + (dataset.empty() ? std::to_string(header_line) : dataset);
}

Table read_table(const std::string& path) {
    if (std::filesystem::is_directory(path)) throw Error("a folder, not a table of poses", path);
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error("the table of poses cannot be opened", path);
    std::string signature(4, '\0');
    file.read(signature.data(), 4);
    return signature == "\x89HDF" ? read_hdf5(path) : read_csv(path);
}

}  // namespace toile::files

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace toile::files {

/// Numbers in named columns, from a CSV or HDF5 file.
struct Table {
    std::string path;
    std::string dataset;              ///< of an HDF5 file; empty for CSV
    std::vector<std::string> column;  ///< `[K]`, no two equal; empty where an HDF5 file does not name them
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> value;  ///< `[N x K]`, finite, N >= 1
    int header_line = 1;                                                           ///< of a CSV file
    std::vector<int> line;                    ///< `[N]` of a CSV file, counted from 1; empty for HDF5
    std::vector<Eigen::Matrix4d> joint_bind;  ///< `[J]` bind transforms of a dataset's joints, or empty

    std::string where(Eigen::Index row) const;  ///< "file:line" or "file:/dataset[row]"
    std::string where_columns() const;          ///< "file:line" of the header or "file:/dataset"
};

/// Reads a table of joint angles. HDF5 (known by its signature) holds either
/// - `/samples/pose` (N,J,3), as our datasets do, with columns `<joint>.x`, `.y`, `.z` from `/body/joint_name` and bind
///   transforms from `/body/joint_bind`, where those are there; or
/// - `/pose` (N,K) with the columns' names in its attribute `columns`.
/// Anything else is CSV: a line of column names, then lines of numbers, separated by commas; blank lines and lines that
/// begin with # are left out. Throws Error with file and line (or dataset) for a missing, empty or binary file, one
/// without rows, a row of the wrong width, columns without a name or named twice, and values that are not finite
/// numbers.
Table read_table(const std::string& path);

}  // namespace toile::files

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "files/hdf5_file.h"

namespace toile::files {

/// The input of a prior (contract, "Problem file"), usually written by another program: a mesh, and predicted positions
/// of any number of samples, which are read a few at a time. Numbers may be stored in any width.
///
/// Throws Error with `where` = "file:/dataset" for what is missing or has another type or shape. Values are not looked
/// at: whether the mesh makes sense is for `prior::rest_state` to say, and a sample may hold NaN.
class ProblemFile {
  public:
    explicit ProblemFile(const std::string& path);

    const std::string& path() const { return file_.path(); }
    const ClothMesh& mesh() const { return mesh_; }  ///< pattern and mass may be empty
    int64_t sample_count() const { return sample_count_; }
    bool has_target() const { return has_target_; }
    /// r̂ `[count x V x 3]` of samples [first, first + count).
    std::vector<double> predicted(int64_t first, int64_t count) const;
    /// r_T, the same shape.
    std::vector<double> target(int64_t first, int64_t count) const;

  private:
    Hdf5File file_;
    ClothMesh mesh_;
    int64_t sample_count_ = 0;
    bool has_target_ = false;
};

/// Writes a problem file, whole or not at all: `predicted` `[N x V x 3]`, and `target` of the same shape or empty.
void write_problem(const std::string& path, const ClothMesh& mesh, std::span<const double> predicted,
                   std::span<const double> target = {});

}  // namespace toile::files

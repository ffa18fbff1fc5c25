#pragma once

#include <tiny_gltf.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "cloth/types.h"

namespace toile::files {

/// Rows of float32 numbers, as a glTF buffer holds them.
template <int columns>
using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, columns, Eigen::RowMajor>;

/// Fills the one buffer of a glTF model, an accessor after the other; each call returns the accessor's index. Throws
/// Error naming `path` where the buffer would pass `gltf_limit`. Internal to files/.
class GltfBuffer {
  public:
    GltfBuffer(tinygltf::Model& model, std::string path);

    int add_vectors(const Positions& rows, bool bounds);  ///< VEC3 float of vertices
    int add_indices(const Triangles& triangle);
    int add_times(const std::vector<float>& seconds);
    int add_floats(const float* value, size_t count, int elements, int type, int target = 0);
    int add_joints(const std::vector<std::uint16_t>& joint);  ///< VEC4 unsigned short of vertices
    /// Makes room for `bytes` more; throws Error unless they fit.
    void reserve(double bytes);

  private:
    void need(double bytes) const;
    int add(const void* data, size_t bytes, int elements, int component, int type, int target);

    tinygltf::Model& model_;
    std::string path_;
};

}  // namespace toile::files

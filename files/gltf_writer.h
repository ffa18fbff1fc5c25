#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "files/mesh_file.h"

namespace toile::files {

/// A skeleton and what hangs on it. A joint's transform relative to its parent (or the world) is its translation, which
/// no pose changes, and its rotation.
struct GltfSkin {
    std::vector<std::string> joint_name;
    std::vector<int> joint_parent;                 ///< `[J]` before its own; -1 for a root
    std::vector<Eigen::Matrix4d> joint_bind;       ///< `[J]` joint to world, rigid
    Eigen::Matrix<float, -1, 3> translation;       ///< `[J x 3]` [m]
    std::vector<int> weight_offset, weight_joint;  ///< `[Vb + 1]`, `[W]`: those of vertex v are offset[v] ...
    std::vector<double> weight_value;              ///< `[W]`
};

/// Writes a binary glTF 2.0 file: meshes at rest, meshes that change their shape from sample to sample (a morph target
/// for each, with normals), and skinned meshes whose joints turn. All share one animation, "samples": sample k is shown
/// from k / rate to (k + 1) / rate seconds and then the next, without a blend, as only the samples are draped. What is
/// not animated shows the first sample.
///
/// The file is held in memory until `commit`, twice while it is written. A morphing mesh takes 24 bytes a vertex and
/// sample, and 4 bytes for each sample of each sample. Throws Error before it passes `gltf_limit`, and where the file
/// cannot be written. It appears whole or not at all.
class GltfWriter {
  public:
    /// `samples` 0: nothing moves. `rate` in samples a second.
    explicit GltfWriter(const std::string& path, int samples = 0, double rate = 1);
    ~GltfWriter();
    GltfWriter(const GltfWriter&) = delete;
    GltfWriter& operator=(const GltfWriter&) = delete;

    /// A mesh without triangles is left out.
    void add_mesh(const NamedMesh& mesh);
    /// `mesh` at rest; as many calls of `add_target` must follow as there are samples.
    void begin_morphing_mesh(const NamedMesh& mesh);
    void add_target(const std::string& name, const Positions& position);
    /// `mesh` in the bind pose. `rotation[j]` `[samples x 4]`: joint j's rotation relative to its parent, x, y, z, w.
    void add_skinned_mesh(const NamedMesh& mesh, const GltfSkin& skin,
                          const std::vector<Eigen::Matrix<float, -1, 4, Eigen::RowMajor>>& rotation);
    void commit();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Programs that show glTF load a file whole, many of them with signed 32-bit sizes.
inline constexpr std::int64_t gltf_limit = (std::int64_t{1} << 31) - 1;

}  // namespace toile::files

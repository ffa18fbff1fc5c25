#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::evaluate {

/// The deformed states of one mesh, read one at a time.
class StrainFrames {
  public:
    virtual ~StrainFrames() = default;
    virtual int count() const = 0;
    virtual std::string name(int k) const = 0;  ///< the file, or "sample 12"
    virtual Positions read(int k) const = 0;    ///< `[V x 3]` [m], finite
    virtual const ClothMesh& mesh() const = 0;  ///< the rest state
    virtual const std::string& rest_name() const = 0;
    virtual std::vector<std::string> notes() const = 0;  ///< what was passed over, for people
};

/// Files in the order given; the files of a folder and of a pattern sorted by name, numbers in it by their value.
/// `rest` empty: the first frame. Throws Error for an empty sequence, a rest state or frame that cannot be read. To
/// read a frame throws one that names it if its number of vertices or its triangles are not those at rest.
std::unique_ptr<StrainFrames> mesh_frames(const std::string& rest, const std::vector<std::string>& sequence);

/// Accepted samples of a data set, of the splits named (none: of all). Throws Error where it cannot be read, or has no
/// such sample.
std::unique_ptr<StrainFrames> dataset_frames(const std::string& dataset, const std::vector<std::string>& split);

/// The files that a sequence names.
std::vector<std::string> sequence_files(const std::vector<std::string>& sequence);

}  // namespace toile::evaluate

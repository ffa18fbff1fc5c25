#pragma once

#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace toile::files {

/// The numbers of a glTF accessor, element by element, integers scaled to [0, 1] or [-1, 1] where it says so.
struct AccessorData {
    int components = 0;  ///< numbers in an element
    int count = 0;       ///< elements
    std::vector<double> value;
    double step = 0;  ///< between neighbouring values of scaled integers, 0 for other numbers
};

/// Reads accessor `index` with its strides, offsets and sparse replacements. Throws Error naming `path` where it has
/// not `components` numbers an element, or points outside its buffer.
AccessorData read_accessor(const tinygltf::Model& model, int index, int components, const std::string& path);

}  // namespace toile::files

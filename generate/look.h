#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace toile::generate {

/// Linear red, green, blue.
inline const Eigen::Vector3f skin_color{0.55f, 0.45f, 0.38f};
inline const Eigen::Vector3f cloth_color{0.16f, 0.33f, 0.62f};

/// Writes what one can look at into `folder`, from a dataset file: `pose_<id>.glb` with body and cloth for each slot in
/// `slots`, and, where the dataset has images, `displacements.png`, a contact sheet of them. Slots that are out of
/// range are passed over, and so are samples whose cloth is not finite. Returns the paths written.
std::vector<std::string> write_look(const std::string& dataset, const std::string& folder,
                                    const std::vector<int>& slots);

}  // namespace toile::generate

#pragma once

#include <string>
#include <vector>

#include "generate/export_samples.h"

namespace toile::generate {

// One a format: writes the samples to `options.out` and returns what was written.
std::vector<std::string> export_npz(const ExportSamples& samples, const ExportOptions& options);
std::vector<std::string> export_meshes(const ExportSamples& samples, const ExportOptions& options);  ///< obj, ply
std::vector<std::string> export_point_cache(const ExportSamples& samples, const ExportOptions& options);
std::vector<std::string> export_gltf(const ExportSamples& samples, const ExportOptions& options);
std::vector<std::string> export_xdmf(const ExportSamples& samples, const ExportOptions& options);

}  // namespace toile::generate

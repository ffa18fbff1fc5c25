#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "generate/progress.h"

namespace toile::generate {

enum class ExportFormat { npz, obj, ply, pc2, gltf, xdmf };

struct ExportOptions {
    std::string dataset;  ///< a data set file, virtual or not
    std::string out;      ///< npz, gltf, xdmf: a file, replaced if it is there; else a folder, which must not be there
    ExportFormat format = ExportFormat::npz;
    bool failed = false;       ///< keep samples that were not accepted too, as far as they are finite
    std::optional<int> split;  ///< only those of one split
    std::vector<std::pair<int64_t, int64_t>> pose;  ///< only pose numbers in one of these, first and last; empty: all
    int64_t at_most = 0;                            ///< of those, so many, evenly spread; 0: all
    bool body = true;                               ///< the posed body too, where the scene has one
    double rate = 1;                                ///< poses a second, where a format knows time
    ProgressCallback progress;                      ///< may be empty
    const std::atomic<bool>* interrupted = nullptr;
};

struct ExportSummary {
    std::vector<std::string> path;  ///< files and folders written
    int samples = 0;
    int not_finite = 0;  ///< failed samples that were asked for and left out
    std::uintmax_t bytes = 0;
};

/// Writes samples of a data set for other programs; what each format holds is in `toile export --help`. Memory does not
/// grow with the number of samples, but for gltf, which is bounded (files/gltf_writer.h). The output appears whole or
/// not at all. Throws Error where the data set is missing, damaged or not ours, nothing is selected, `out` has another
/// extension, is in the way or cannot be written; Interrupted once `interrupted` is set.
ExportSummary export_dataset(const ExportOptions& options);

/// Pose numbers as one writes them: "7", "3,10-20". Throws Error for anything else.
std::vector<std::pair<int64_t, int64_t>> parse_pose_ranges(const std::string& text);

/// Writes the time series of a data set beside it: a/dataset.h5 -> a/dataset.xdmf, which refers to it, and where there
/// is a body a/dataset.body.h5 with its positions. At most 200 samples, evenly spread, accepted or not, so that time
/// and disk stay small whatever the number of samples; nothing where no sample is finite. Throws Error where it cannot
/// be written.
void write_xdmf(const std::string& dataset);

}  // namespace toile::generate

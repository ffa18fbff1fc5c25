#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "evaluate/neighbourhood.h"
#include "evaluate/strain_results.h"
#include "generate/progress.h"

namespace toile::evaluate {

struct StrainOptions {
    std::string rest;  ///< .obj, .ply, or an HDF5 file of ours, whose /mesh has a pattern; empty: first frame
    std::vector<std::string> sequence;  ///< files, folders and patterns ("frames/*.ply"); a pair has one frame
    std::string dataset;                ///< instead of a sequence: its accepted samples are the frames
    std::vector<std::string> split;     ///< of the data set: train, validation, test; none: all
    NeighbourhoodRule neighbourhood;
    double normal_weight = 1;         ///< in the fit at a vertex (evaluate/vertex_strain.h), >= 0
    double time_step = 0;             ///< between frames [s]; 0: no rates
    bool stretches_only = false;      ///< leave gradients, rotations and directions out of the file
    int look = 0;                     ///< coloured meshes, of frames evenly chosen
    std::string look_format = "ply";  ///< or glb
    std::string folder;
    int jobs = 1;
    std::string command;
    generate::ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;
};

/// Measures strain after Rohmer et al. and Kabsch, and writes `folder`/strain.h5 (files/strain_file.h), strain.json and
/// the coloured meshes, each whole or not at all. Memory does not grow with the number of frames, but for a few numbers
/// of each; the files do not depend on `jobs`. Throws Error for input at fault, before anything is written where it
/// can, and never leaves half a result; generate::Interrupted if someone asked it to end.
StrainSummary evaluate_strain(const StrainOptions& options);

}  // namespace toile::evaluate

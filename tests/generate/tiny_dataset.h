#pragma once

#include <functional>
#include <string>

#include "files/dataset_file.h"

namespace toile::generate {

/// A whole dataset of four samples made by hand: two sewn panels carried by a bending tube of two joints, with
/// displacements, images and certificates that are right. The two changes damage what is written.
struct TinyDataset {
    static constexpr int samples = 4;
    std::function<void(files::DatasetHeader&)> change_header = [](files::DatasetHeader&) {};
    std::function<void(int slot, files::SampleRecord&)> change_sample = [](int, files::SampleRecord&) {};

    void write(const std::string& path) const;
};

}  // namespace toile::generate

#pragma once

#include "files/dataset_file.h"
#include "generate/sample.h"
#include "generate/scene.h"
#include "pattern/pattern_image.h"

namespace toile::generate {

/// What the data set says about all samples. `image` is null where there are no images.
files::DatasetHeader dataset_header(const DressedScene& dressed, const pattern::PatternImage* image);

files::CertificateRecord certificate_record(const simulate::Certificate& certificate);

/// One sample as it is stored, without its image.
files::SampleRecord sample_record(Sample sample, int split);

}  // namespace toile::generate

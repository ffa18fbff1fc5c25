#pragma once

#include "files/dataset_file.h"
#include "skin/skinning.h"

namespace toile::generate {

/// A dataset's body as the skin room knows it, without roles; weights in vertex order. Indices must be in range.
skin::Body skinned_body(const files::DatasetBody& stored);

struct CarriedBody {
    Positions position;  ///< `[Vb x 3]` the body in the sample's pose [m]
    skin::SkinningMethod method = skin::SkinningMethod::linear;
    double distance = 0;  ///< largest distance of the embedding carried by it from the stored r̃ [m]
};

/// The body in a sample's pose. The file does not say how it was skinned: linear blend skinning or dual quaternions,
/// whichever carries the embedding nearer to the stored r̃. Needs an embedding and a finite pose.
CarriedBody posed_as_stored(const files::DatasetHeader& header, const skin::Body& body,
                            const files::SampleRecord& sample);

}  // namespace toile::generate

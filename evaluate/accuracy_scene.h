#pragma once

#include <optional>
#include <string>

#include "evaluate/report_scene.h"

namespace toile::evaluate {

/// A scene with the binary data it refers to.
struct SceneData {
    ReportScene scene;
    BlobStore store;

    size_t bytes() const;  ///< that blobs and pictures take of the page
};

/// The samples that `toile evaluate accuracy` left to be shown, in `accuracy.h5` under /shown. Views whose cloth is not
/// finite are left out of a sample. Nothing where the folder has no such file, or it shows nothing. Throws Error,
/// naming file and dataset, where it cannot be read or does not fit together.
std::optional<SceneData> accuracy_scene(const std::string& folder);

}  // namespace toile::evaluate

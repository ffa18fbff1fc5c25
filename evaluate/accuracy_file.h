#pragma once

#include <string>

#include "evaluate/accuracy.h"
#include "evaluate/accuracy_shown.h"
#include "files/dataset_file.h"

namespace toile::evaluate {

/// Writes an accuracy.h5 (all arrays of an evaluation) at `path`.
///
/// `/mesh/...` and, with a body, `/body/triangle`. `/figures/id`, `/figures/split` (N), then for each predictor and
/// method `/figures/<predictor>/<method>/<quantity>` (N) in the quantity's unit (attribute `unit`) and `.../status` (N)
/// int8; those of the truth under `/figures/target/target`. `/shown/id`, `/shown/split` (S), `/shown/body` (S,Vb,3),
/// `/shown/image` (S,C,H,W), and for each view `/shown/<view>/position` (S,V,3) [m], `.../distance`, `.../stretch`,
/// `.../strain` (S,V), see `ClothFields`; attribute `title` of each view.
/// Where μ was learned, `/mu/global` and `/mu/vertex` (V) for the first predictor (attribute `predictor`).
void write_accuracy_file(const std::string& path, const files::DatasetHeader& header, const Shown& shown,
                         const AccuracySummary& summary);

}  // namespace toile::evaluate

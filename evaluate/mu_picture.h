#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "cloth/cloth_mesh.h"
#include "evaluate/report_document.h"
#include "files/image_file.h"

namespace toile::evaluate {

/// μ over the garment (paper, Figure 10): the panels of the flat pattern side by side, purple where μ is low, yellow
/// where it is high, on a logarithmic scale with a bar below. A mesh without pattern is drawn from the front and from
/// the back. `mu`: `[V]`, positive. Throws Error where it does not fit the mesh.
files::Picture mu_picture(const ClothMesh& mesh, const Eigen::VectorXd& mu);

/// What the picture shows, in words: its range and its quartiles.
std::string mu_alt_text(const Eigen::VectorXd& mu);

/// The same as a block of a report.
ReportPicture mu_block(const ClothMesh& mesh, const Eigen::VectorXd& mu, const std::string& id);

/// The block of what an accuracy evaluation learned (`/mu/vertex` of its accuracy.h5); nothing where it learned no μ
/// per vertex. Throws Error where the file cannot be read.
std::optional<ReportPicture> learned_mu_block(const std::string& accuracy_file);

}  // namespace toile::evaluate

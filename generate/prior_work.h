#pragma once

#include <memory>
#include <span>
#include <vector>

#include "files/projection_file.h"
#include "generate/project_config.h"
#include "prior/rest_state.h"

namespace toile::generate {

/// One prior at work on samples of one mesh, a few at a time: what the two have in common.
class PriorWork {
  public:
    virtual ~PriorWork() = default;

    /// The model's tables, for the file.
    virtual void describe(files::ProjectionHeader& header) const = 0;
    /// Projects `predicted` `[n x V x 3]`.
    virtual void project(std::span<const double> predicted) = 0;
    /// Derivatives at what `project` gave last, of a loss with the gradient `loss_gradient` `[n x V x 3]`.
    virtual void differentiate(std::span<const double> predicted, std::span<const double> loss_gradient) = 0;
    /// Makes the derivatives of sample `i` NaN.
    virtual void void_gradient(size_t i) = 0;

    virtual const std::vector<double>& position() const = 0;
    virtual const std::vector<prior::Report>& report() const = 0;
    virtual const std::vector<prior::DerivativeReport>& derivative_report() const = 0;
    /// Points `rows` at the results; the derivatives too if `gradient`.
    virtual void fill(files::ProjectionRows& rows, bool gradient) const = 0;
};

/// Throws Error for a model that makes no sense. `threads` share each call's samples.
std::unique_ptr<PriorWork> make_prior_work(const ProjectConfig& config, const prior::RestState& rest, int threads);

}  // namespace toile::generate

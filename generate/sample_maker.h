#pragma once

#include <memory>
#include <string>

#include "files/plan_file.h"
#include "generate/scene.h"
#include "pattern/pattern_image.h"

namespace toile::generate {

/// Makes the samples of a corpus from its configuration and plan: what a worker process holds.
class SampleMaker {
  public:
    /// Builds the scene again, with the plan's neutral drape. `folder` is the corpus' own: replays of samples that fail
    /// are written there.
    SampleMaker(const SceneConfig& config, const files::CorpusPlan& plan, std::string folder);

    /// The sample of a slot: skinned, draped, embedded, rasterised where the plan has images. Depends on configuration
    /// and slot alone.
    files::SampleRecord make(int slot) const;

    /// The image of a record that was made without one, and its error.
    void rasterise(files::SampleRecord& record) const;

    /// What is stored for a slot whose worker ended without a sample, for the reason `status`: its pose, and NaN.
    files::SampleRecord lost(int slot, simulate::DrapeStatus status) const;

  private:
    const files::CorpusPlan& plan_;
    const std::string folder_;
    DressedScene dressed_;
    std::unique_ptr<pattern::PatternImage> image_;  ///< null without images
};

}  // namespace toile::generate

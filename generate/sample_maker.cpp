#include "generate/sample_maker.h"

#include <limits>

#include "generate/dataset_header.h"
#include "generate/replay.h"
#include "generate/sample.h"

namespace toile::generate {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::unique_ptr<pattern::PatternImage> image_of(const files::CorpusPlan& plan, const DressedScene& dressed) {
    if (!plan.header.image) return nullptr;
    pattern::ImageOptions options = *dressed.scene.config.image;
    options.size = plan.header.image->size;
    return std::make_unique<pattern::PatternImage>(dressed.mesh, dressed.scene.garment.triangle_panel, options);
}

}  // namespace

SampleMaker::SampleMaker(const SceneConfig& config, const files::CorpusPlan& plan, std::string folder)
    : plan_(plan),
      folder_(std::move(folder)),
      dressed_(dress_again(build_scene(config), plan.header.mesh.rest_position)),
      image_(image_of(plan, dressed_)) {}

files::SampleRecord SampleMaker::make(int slot) const {
    Sample sample = make_sample(dressed_, plan_.pose_number[slot]);
    if (const auto replay = replay_record(dressed_, sample)) write_replay_of(folder_, *replay);
    files::SampleRecord record = sample_record(std::move(sample), plan_.split[slot]);
    rasterise(record);
    return record;
}

void SampleMaker::rasterise(files::SampleRecord& record) const {
    if (!image_) return;
    // The image shows what is stored: a record that was kept in between gives the same picture.
    record.displacement = record.displacement.cast<float>().cast<double>();
    record.image = image_->image(record.displacement);
    pattern::ResamplingError error;
    error.add(record.displacement, image_->read(record.image));
    record.resampling_error = {error.largest, error.root_mean_square()};
}

files::SampleRecord SampleMaker::lost(int slot, simulate::DrapeStatus status) const {
    Sample sample;
    sample.id = plan_.pose_number[slot];
    sample.pose = dressed_.scene.poses->pose(sample.id);
    sample.status = status;
    const Eigen::Index vertices = dressed_.mesh.vertex_count();
    sample.cloth = sample.draped = Positions::Constant(vertices, 3, nan);
    sample.certificate.residual_force = sample.certificate.max_speed = sample.certificate.seconds = nan;
    sample.certificate.body_penetration = sample.certificate.max_stretch = sample.certificate.min_stretch = nan;
    sample.tries.push_back({0, status, sample.certificate});
    write_replay_of(folder_, *replay_record(dressed_, sample));
    if (plan_.header.embedding) {
        sample.embedded.position = sample.displacement = sample.cloth;
        sample.embedded.frame.assign(static_cast<size_t>(vertices), Eigen::Quaterniond(nan, nan, nan, nan));
    }
    files::SampleRecord record = sample_record(std::move(sample), plan_.split[slot]);
    if (plan_.header.image) {
        const files::DatasetImage& image = *plan_.header.image;
        record.image.assign(static_cast<size_t>(3) * image.layers * image.size * image.size, static_cast<float>(nan));
        record.resampling_error = {nan, nan};
    }
    return record;
}

}  // namespace toile::generate

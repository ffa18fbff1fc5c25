#include "generate/image_size.h"

#include <algorithm>

namespace toile::generate {
namespace {

constexpr int batch = 64;  // samples in memory at a time

}  // namespace

pattern::ImageOptions fitting_image(const DressedScene& dressed, const files::DatasetReader& drapes,
                                    std::vector<std::string>& remarks) {
    pattern::ImageOptions options = *dressed.scene.config.image;
    const std::vector<int>& panel = dressed.scene.garment.triangle_panel;
    int size = 0;
    bool reached = true;
    for (int first = 0; first < drapes.sample_count(); first += batch) {
        std::vector<Positions> displacement;
        for (int slot = first; slot < std::min(first + batch, drapes.sample_count()); ++slot) {
            files::SampleRecord record = drapes.read(slot);
            if (record.status == 0) displacement.push_back(std::move(record.displacement));
        }
        const pattern::AutoImageSize fit = pattern::auto_image_size(dressed.mesh, panel, options, displacement);
        size = std::max(size, fit.size);
        reached = reached && fit.reached;
    }
    options.size = size;
    if (!reached) remarks.push_back("image.max_error is not reached, not even by the largest image");
    return options;
}

}  // namespace toile::generate

#include "generate/sample.h"

namespace toile::generate {

Sample make_sample(const DressedScene& dressed, std::int64_t number) {
    const skin::Body& body = *dressed.scene.body;
    Sample sample;
    sample.id = number;
    sample.pose = dressed.scene.poses->pose(number);
    simulate::DrapeResult drape = dressed.draper->drape(dressed.neutral.position, sample.pose);
    const Positions posed = skin::skin_positions(body, sample.pose, dressed.scene.config.body->skinning);
    sample.embedded = pattern::carry(*dressed.embedding, body, sample.pose, posed);
    sample.displacement = pattern::displacement(sample.embedded, drape.position);
    sample.cloth = std::move(drape.position);
    sample.certificate = drape.certificate;
    sample.status = drape.status;
    sample.report = drape.report;
    return sample;
}

}  // namespace toile::generate

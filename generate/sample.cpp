#include "generate/sample.h"

namespace toile::generate {

Sample make_sample(const DressedScene& dressed, std::int64_t number) {
    const skin::Body& body = *dressed.scene.body;
    Sample sample;
    sample.id = number;
    sample.pose = dressed.scene.poses->pose(number);
    simulate::DrapeResult drape = dressed.draper->drape(dressed.mesh.rest_position, sample.pose);
    const Positions posed = skin::skin_positions(body, sample.pose, dressed.scene.config.body->skinning);
    // The displacement is taken between what will be stored, so that the identity holds for whoever reads the file.
    sample.embedded = pattern::rounded(pattern::carry(*dressed.embedding, body, sample.pose, posed));
    sample.cloth = drape.position.cast<float>().cast<double>();
    sample.displacement = pattern::displacement(sample.embedded, sample.cloth);
    sample.certificate = drape.certificate;
    sample.status = drape.status;
    sample.report = drape.report;
    sample.draped = std::move(drape.position);
    sample.tries = std::move(drape.tries);
    return sample;
}

}  // namespace toile::generate

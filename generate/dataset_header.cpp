#include "generate/dataset_header.h"

namespace toile::generate {
namespace {

files::DatasetBody dataset_body(const skin::Body& body) {
    files::DatasetBody stored;
    stored.triangle = body.triangle;
    stored.rest_position = body.rest_position;
    for (const skin::Joint& joint : body.joint) {
        stored.joint_name.push_back(joint.name);
        stored.joint_parent.push_back(joint.parent);
        stored.joint_bind.push_back(joint.bind);
    }
    for (int v = 0; v < body.vertex_count(); ++v)
        for (int i = body.weight.offset[v]; i < body.weight.offset[v + 1]; ++i) {
            stored.weight_vertex.push_back(v);
            stored.weight_joint.push_back(body.weight.joint[i]);
            stored.weight_value.push_back(body.weight.value[i]);
        }
    return stored;
}

files::DatasetImage dataset_image(const pattern::PatternImage& image) {
    const pattern::PatternLayout& layout = image.layout();
    return {layout.size, layout.layers, layout.pattern_pixel, image.mask()};
}

}  // namespace

files::DatasetHeader dataset_header(const DressedScene& dressed, const pattern::PatternImage* image) {
    const SceneConfig& config = dressed.scene.config;
    files::DatasetHeader header;
    header.mesh = dressed.mesh;
    if (dressed.scene.body) header.body = dataset_body(*dressed.scene.body);
    if (dressed.embedding) header.embedding = {dressed.embedding->triangle, dressed.embedding->barycentric};
    if (image) header.image = dataset_image(*image);
    header.config = config.text;
    header.config_hash = config.hash;
    header.program_version = TOILE_VERSION;
    header.seed = static_cast<std::int64_t>(config.seed);
    for (const std::string_view reason : simulate::status_reasons()) header.reasons.emplace_back(reason);
    header.gate = {{"body_penetration", config.gate.body_penetration},
                   {"residual_force", config.gate.residual_force},
                   {"max_stretch", config.gate.max_stretch}};
    header.duplicate_angle = config.split.duplicate_angle;
    return header;
}

files::SampleRecord sample_record(Sample sample, int split) {
    files::SampleRecord record;
    record.id = sample.id;
    record.split = split;
    record.status = static_cast<int>(sample.status);
    record.pose = std::move(sample.pose);
    record.cloth = std::move(sample.cloth);
    record.embedded = std::move(sample.embedded.position);
    record.frame = std::move(sample.embedded.frame);
    record.displacement = std::move(sample.displacement);
    const simulate::Certificate& c = sample.certificate;
    record.certificate = {c.residual_force, c.body_penetration, c.max_stretch,       c.min_stretch,
                          c.max_speed,      c.seconds,          c.self_intersections};
    return record;
}

}  // namespace toile::generate

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
    header.gate = simulate::gate_bounds(config.gate);
    header.duplicate_angle = config.split.duplicate_angle;
    return header;
}

files::CertificateRecord certificate_record(const simulate::Certificate& c) {
    files::CertificateRecord record;
    record.residual_force = c.residual_force;
    record.body_penetration = c.body_penetration;
    record.max_stretch = c.max_stretch;
    record.min_stretch = c.min_stretch;
    record.max_speed = c.max_speed;
    record.seconds = c.seconds;
    record.self_intersections = c.self_intersections;
    record.detail = {c.moving_share, c.body_crossings, c.iterations, c.path_steps, c.tries, c.rung, {}, {}};
    for (size_t k = 0; k < c.rungs.size(); ++k) {
        record.detail->rung_status[k] = c.rungs[k].status;
        record.detail->rung_residual_force[k] = c.rungs[k].residual_force;
    }
    return record;
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
    record.certificate = certificate_record(sample.certificate);
    return record;
}

}  // namespace toile::generate

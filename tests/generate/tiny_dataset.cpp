#include "tests/generate/tiny_dataset.h"

#include <cmath>
#include <numbers>

#include "generate/stored_body.h"
#include "pattern/embedding.h"
#include "pattern/pattern_image.h"
#include "simulate/certificate.h"
#include "skin/skinning.h"
#include "tests/pattern/two_panels.h"

namespace toile::generate {
namespace {

/// A closed tube along x from -0.1 to 0.5 m, radius 0.1 m, with a joint at x = 0 and one at x = 0.2.
files::DatasetBody tube() {
    constexpr int rings = 25, around = 24;
    files::DatasetBody body;
    body.rest_position.resize(rings * around + 2, 3);
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < around; ++k) {
            const double x = -0.1 + 0.6 * i / (rings - 1), angle = 2 * std::numbers::pi * k / around;
            body.rest_position.row(i * around + k) << x, 0.1 * std::cos(angle), 0.1 * std::sin(angle);
        }
    }
    const int left = rings * around, right = left + 1;
    body.rest_position.row(left) << -0.1, 0, 0;
    body.rest_position.row(right) << 0.5, 0, 0;
    std::vector<std::array<int, 3>> triangle;
    for (int k = 0; k < around; ++k) {
        const int next = (k + 1) % around;
        for (int i = 0; i + 1 < rings; ++i) {
            const int a = i * around + k, b = i * around + next, c = a + around, d = b + around;
            triangle.push_back({a, b, c});
            triangle.push_back({b, d, c});
        }
        triangle.push_back({left, next, k});
        triangle.push_back({right, (rings - 1) * around + k, (rings - 1) * around + next});
    }
    body.triangle.resize(static_cast<Eigen::Index>(triangle.size()), 3);
    for (size_t f = 0; f < triangle.size(); ++f)
        for (int k = 0; k < 3; ++k) body.triangle(static_cast<Eigen::Index>(f), k) = triangle[f][k];
    body.joint_name = {"root", "elbow"};
    body.joint_parent = {-1, 0};
    body.joint_bind = {Eigen::Matrix4d::Identity(), Eigen::Matrix4d::Identity()};
    body.joint_bind[1](0, 3) = 0.2;
    for (int v = 0; v < body.rest_position.rows(); ++v) {
        const double share = std::clamp((body.rest_position(v, 0) - 0.1) / 0.2, 0.0, 1.0);
        for (int j = 0; j < 2; ++j) {
            body.weight_vertex.push_back(v);
            body.weight_joint.push_back(j);
            body.weight_value.push_back(j == 0 ? 1 - share : share);
        }
    }
    return body;
}

files::DatasetHeader shared_part(const ClothMesh& mesh, const pattern::Embedding& embedding,
                                 const files::DatasetBody& body, const pattern::PatternImage& image) {
    files::DatasetHeader header;
    header.mesh = mesh;
    header.body = body;
    header.embedding = files::DatasetEmbedding{embedding.triangle, embedding.barycentric};
    header.image =
        files::DatasetImage{image.layout().size, image.layout().layers, image.layout().pattern_pixel, image.mask()};
    header.config = "name = \"tiny\"\n";
    header.config_hash = "0123456789abcdef0123456789abcdef";
    header.program_version = "0.1.0";
    header.reasons = {"accepted", "not at rest"};
    header.gate = {{"body_penetration", 0.001}, {"residual_force", 0.001}, {"max_stretch", 2.0}};
    header.duplicate_angle = 0.15;
    return header;
}

}  // namespace

void TinyDataset::write(const std::string& path) const {
    ClothMesh mesh = pattern::two_panels(8).mesh;
    mesh.rest_position.col(1).array() -= 0.1;
    mesh.rest_position.col(2).array() += 0.14;
    mesh.mass = lumped_mass(mesh, 0.2);
    const files::DatasetBody stored = tube();
    const skin::Body body = skinned_body(stored);
    const pattern::Embedding embedding = pattern::embed(mesh, body);
    pattern::ImageOptions options;
    options.size = 48;
    const pattern::PatternImage image(mesh, {}, options);
    const Topology topology = build_topology(mesh.triangle);
    const Eigen::VectorXd rest_length = simulate::edge_rest_lengths(mesh, topology);
    const Positions neutral = pattern::displacement(
        pattern::carry(embedding, body, skin::Pose::Zero(2, 3), body.rest_position), mesh.rest_position);

    files::DatasetHeader header = shared_part(mesh, embedding, stored, image);
    change_header(header);
    files::DatasetWriter writer(path, header, samples, 4);
    for (int slot = 0; slot < samples; ++slot) {
        files::SampleRecord sample;
        sample.id = 10 + slot;
        sample.split = slot < 2 ? 0 : slot - 1;
        sample.pose = skin::Pose::Zero(2, 3);
        sample.pose(1, 2) = 0.2 * slot;
        const Positions posed = skin::skin_positions(body, sample.pose, skin::SkinningMethod::linear);
        const pattern::EmbeddedCloth carried = pattern::carry(embedding, body, sample.pose, posed);
        sample.embedded = carried.position;
        sample.frame = carried.frame;
        sample.displacement = neutral + 0.1 * pattern::fold_probe(mesh.rest_position);
        sample.cloth = pattern::displaced(carried, sample.displacement);
        sample.image = image.image(sample.displacement);
        pattern::ResamplingError error;
        error.add(sample.displacement, image.read(sample.image));
        sample.resampling_error = {error.largest, error.root_mean_square()};
        const auto stretch = simulate::stretch_range(topology, rest_length, sample.cloth);
        sample.certificate.residual_force = 1e-4;
        sample.certificate.body_penetration = simulate::body_penetration(body.triangle, posed, sample.cloth);
        sample.certificate.max_stretch = stretch.largest;
        sample.certificate.min_stretch = stretch.smallest;
        sample.certificate.max_speed = 1e-4;
        sample.certificate.seconds = 1.0;
        sample.certificate.detail = {0.0, 0, 40, 10, 1, 0};
        change_sample(slot, sample);
        writer.write(slot, sample);
    }
    writer.finish();
}

}  // namespace toile::generate

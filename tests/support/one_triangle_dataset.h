#pragma once

#include <gtest/gtest.h>

#include "files/dataset_file.h"

namespace toile::test {

using files::DatasetBody;
using files::DatasetEmbedding;
using files::DatasetHeader;
using files::DatasetImage;
using files::SampleRecord;

/// One triangle on a body of one triangle and two joints, with an image of 2 x 2 pixels.
inline DatasetHeader header_of(bool with_body, bool with_image) {
    DatasetHeader header;
    header.mesh.triangle.resize(1, 3);
    header.mesh.triangle << 0, 1, 2;
    header.mesh.pattern_triangle = header.mesh.triangle;
    header.mesh.rest_position.resize(3, 3);
    header.mesh.rest_position << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    header.mesh.pattern_position = header.mesh.rest_position.leftCols<2>();
    header.mesh.mass = Eigen::Vector3d(0.1, 0.2, 0.3);
    header.config = "name = \"tiny\"\n";
    header.config_hash = "0123456789abcdef0123456789abcdef";
    header.program_version = "0.1.0";
    header.seed = 42;
    header.reasons = {"accepted", "not at rest"};
    header.gate = {{"body_penetration", 0.001}, {"max_stretch", 1.3}};
    header.duplicate_angle = 0.15;
    if (!with_body) return header;
    DatasetBody body;
    body.triangle = header.mesh.triangle;
    body.rest_position = header.mesh.rest_position;
    body.joint_name = {"hip", "knee"};
    body.joint_parent = {-1, 0};
    body.joint_bind = {Eigen::Matrix4d::Identity(), Eigen::Matrix4d::Identity()};
    body.joint_bind[1](0, 3) = 0.5;
    body.weight_vertex = {0, 1, 2};
    body.weight_joint = {0, 1, 0};
    body.weight_value = {1, 1, 1};
    header.body = body;
    header.embedding = DatasetEmbedding{{0, 0, 0}, Positions::Identity(3, 3)};
    if (with_image) header.image = DatasetImage{2, 1, Positions::Zero(3, 3), {1, 1, 0, 1}};
    return header;
}

inline SampleRecord sample_of(const DatasetHeader& header, int slot) {
    SampleRecord sample;
    sample.id = 100 + slot;
    sample.split = slot % 3;
    sample.status = slot % 2;
    sample.cloth = Positions::Constant(3, 3, 0.25 + slot);
    sample.certificate = {1e-4, 2e-4, 1.125, 0.875, 1e-3, 0.5 + slot, slot};
    if (header.body) sample.pose = Positions::Constant(2, 3, 0.1 * slot);
    if (header.embedding) {
        sample.embedded = Positions::Constant(3, 3, 0.5 + slot);
        sample.displacement = Positions::Constant(3, 3, -0.25);
        sample.frame.assign(3, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5));
    }
    if (header.image) {
        sample.image.assign(12, 0.125f * static_cast<float>(slot));
        sample.resampling_error = {1e-4 * (slot + 1), 1e-5 * (slot + 1)};
    }
    return sample;
}

inline void expect_same(const SampleRecord& a, const SampleRecord& b) {
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.split, b.split);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.pose, b.pose);
    EXPECT_EQ(a.cloth, b.cloth);
    EXPECT_EQ(a.embedded, b.embedded);
    EXPECT_EQ(a.displacement, b.displacement);
    ASSERT_EQ(a.frame.size(), b.frame.size());
    for (size_t v = 0; v < a.frame.size(); ++v) EXPECT_EQ(a.frame[v].coeffs(), b.frame[v].coeffs());
    EXPECT_EQ(a.image, b.image);
    EXPECT_EQ(a.resampling_error, b.resampling_error);
    EXPECT_EQ(a.certificate.self_intersections, b.certificate.self_intersections);
    EXPECT_EQ(a.certificate.max_stretch, b.certificate.max_stretch);
    EXPECT_EQ(a.certificate.seconds, b.certificate.seconds);
}

}  // namespace toile::test

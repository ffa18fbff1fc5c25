#include <gtest/gtest.h>

#include <cmath>

#include "cloth/error.h"
#include "pattern/body_measure.h"
#include "skin/builtin_body.h"

namespace toile::pattern {
namespace {

TEST(BodyMeasure, built_in_body_has_an_adults_measures) {
    const skin::Body body = skin::make_builtin_body({.voxel = 0.025});
    const BodyMeasure measure = measure_body(body);
    EXPECT_NEAR(measure.chest, 0.98, 0.15);
    EXPECT_NEAR(measure.shoulder_half_width, 0.18, 0.04);
    EXPECT_NEAR(measure.center_x, 0.0, 0.005);
    EXPECT_LT(measure.hip_height, measure.underarm_height);
    EXPECT_LT(measure.underarm_height, measure.neck_height);
    EXPECT_GT(measure.neck_half_width, 0.03);
    EXPECT_LT(measure.neck_half_width, 0.09);
    for (int side = 0; side < 2; ++side) {
        const ArmMeasure& arm = measure.arm[side];
        EXPECT_NEAR(arm.circumference, 0.3, 0.08);
        EXPECT_EQ(arm.notch.x() > 0.0, side == 0);
        EXPECT_LT(arm.notch.y(), arm.shoulder.y());
        EXPECT_GT(arm.notch.y(), arm.shoulder.y() - 0.15);
        ASSERT_EQ(arm.station.size(), arm.center.size());
        ASSERT_GT(arm.station.size(), 10u);
        // Sections lie about the arm's axis.
        const Eigen::Vector3d along = (arm.elbow - arm.shoulder).normalized();
        const Eigen::Vector3d on_axis = arm.shoulder + arm.station[2] * along;
        EXPECT_LT((arm.center[2] - on_axis).norm(), 0.03);
    }
    EXPECT_NEAR(measure.arm[0].circumference, measure.arm[1].circumference, 0.01);
    EXPECT_NEAR(measure.arm[0].notch.y(), measure.arm[1].notch.y(), 0.03);
}

TEST(BodyMeasure, grows_with_the_body) {
    const BodyMeasure slim = measure_body(skin::make_builtin_body({.girth = 0.85, .voxel = 0.025}));
    const BodyMeasure stout = measure_body(skin::make_builtin_body({.girth = 1.2, .voxel = 0.025}));
    EXPECT_NEAR(stout.chest / slim.chest, 1.2 / 0.85, 0.12);
    EXPECT_GT(stout.arm[0].circumference, 1.15 * slim.arm[0].circumference);
}

TEST(BodyMeasure, body_lying_down_is_refused) {
    skin::Body body = skin::make_builtin_body({.voxel = 0.03});
    body.rest_position.col(1).swap(body.rest_position.col(2));
    body.rest_position.col(2) *= -1.0;
    for (skin::Joint& joint : body.joint) {
        joint.bind.row(1).swap(joint.bind.row(2));
        joint.bind.row(2) *= -1.0;
    }
    EXPECT_THROW(measure_body(body), Error);
}

}  // namespace
}  // namespace toile::pattern

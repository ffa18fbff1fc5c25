#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "cloth/error.h"
#include "skin/body.h"
#include "tests/skin/two_bones.h"

namespace toile::skin {
namespace {

using testing_support::two_bones;

void expect_refused(const std::function<void(Body&)>& damage, const std::string& word) {
    Body body = two_bones();
    damage(body);
    try {
        check_body(body, "a.glb");
        ADD_FAILURE() << "accepted: " << word;
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr(word));
        EXPECT_EQ(error.where(), "a.glb");
    }
}

TEST(CheckBody, AcceptsAnOpenSurface) {
    EXPECT_NO_THROW(check_body(two_bones(), "a.glb"));
}

TEST(CheckBody, RefusesSurfaceDefects) {
    expect_refused([](Body& b) { b.triangle.resize(0, 3); }, "no faces");
    expect_refused([](Body& b) { b.rest_position(2, 1) = std::numeric_limits<double>::quiet_NaN(); }, "vertex 2");
    expect_refused([](Body& b) { b.triangle(1, 2) = 5; }, "triangle 1 refers to vertex 5 of 5");
    expect_refused([](Body& b) { b.triangle(1, 2) = -1; }, "triangle 1 refers to vertex -1");
}

TEST(CheckBody, RefusesSkeletonDefects) {
    expect_refused([](Body& b) { b.joint.clear(); }, "no joints");
    expect_refused([](Body& b) { b.joint[1].parent = 1; }, "'upper' (1) has parent 1");
    expect_refused([](Body& b) { b.joint[1].parent = -1; }, "only joint 0 has none");
    expect_refused([](Body& b) { b.joint[1].bind *= 2; }, "'upper' is not rigid");
    expect_refused([](Body& b) { b.joint[0].bind.col(0) *= -1; }, "'lower' is not rigid");
    expect_refused([](Body& b) { b.joint[0].bind(0, 3) = std::numeric_limits<double>::infinity(); }, "not rigid");
    expect_refused([](Body& b) { b.role[Role::head] = 2; }, "role head refers to joint 2 of 2");
}

TEST(CheckBody, RefusesWeightDefects) {
    expect_refused([](Body& b) { b.weight.value[1] = 0.7; }, "weights of body vertex 1 sum to 0.95");
    expect_refused([](Body& b) { b.weight.value[1] = 1.25, b.weight.value[2] = -0.25; },
                   "vertex 1 has the weight -0.25");
    expect_refused([](Body& b) { b.weight.value[7] = std::numeric_limits<double>::quiet_NaN(); }, "vertex 4");
    expect_refused([](Body& b) { b.weight.joint[3] = 2; }, "vertex 2 hangs on joint 2 of 2");
    expect_refused([](Body& b) { b.weight.offset.pop_back(); }, "do not fit");
    expect_refused([](Body& b) { b.weight.offset[2] = 0; }, "vertex 1 are out of order");
    expect_refused([](Body& b) { b.weight.value.pop_back(); }, "do not fit");
}

}  // namespace
}  // namespace toile::skin

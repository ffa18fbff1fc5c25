#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "evaluate/problem_meshes.h"
#include "evaluate/stress_predictions.h"

namespace toile::evaluate {
namespace {

Positions patch(int columns = 12, int rows = 10) {
    Random random(1);
    return flat_patch(columns, rows, 0.02, 0.2, random).rest_position;
}

double root_mean_square(const Positions& field) {
    return std::sqrt(field.squaredNorm() / static_cast<double>(field.rows()));
}

TEST(Predictions, FieldsHaveUnitSize) {
    Random random(1);
    EXPECT_NEAR(root_mean_square(smooth_field(patch(), random)), 1.0, 1e-12);
    EXPECT_NEAR(root_mean_square(white_field(50, random)), 1.0, 1e-12);
}

TEST(Predictions, ASmoothFieldIsSmooth) {
    Random random(1);
    const Positions rest = patch(40, 40), field = smooth_field(rest, random);
    for (int v = 0; v + 1 < 40; ++v) EXPECT_LT((field.row(v) - field.row(v + 1)).norm(), 1.0);
}

TEST(Predictions, BendingAFlatClothKeepsItsLengths) {
    Random random(1);
    const Positions rest = patch(), rolled = bent(rest, random);
    EXPECT_GT((rolled.colwise().maxCoeff() - rolled.colwise().minCoeff())[2], 0.005);
    for (int v = 0; v + 1 < 12; ++v)
        EXPECT_NEAR((rolled.row(v) - rolled.row(v + 1)).norm(), (rest.row(v) - rest.row(v + 1)).norm(), 1e-4);
}

TEST(Predictions, TheErrorHasTheSizeAskedFor) {
    Random one(5), two(5);
    const Positions rest = patch();
    EXPECT_NEAR(root_mean_square(predicted_positions(rest, 0.02, 0.3, one) - predicted_positions(rest, 0.0, 0.3, two)),
                0.02, 1e-12);
}

TEST(Predictions, EveryKindIsFiniteNamedAndDrawnFromItsSeed) {
    std::set<std::string_view> names;
    for (int k = 0; k < prediction_kind_count; ++k) {
        const auto kind = static_cast<PredictionKind>(k);
        names.insert(name(kind));
        Random one(9), two(9);
        const Positions a = extreme_positions(patch(), kind, 0.02, 0.1, 0.0, one);
        EXPECT_TRUE(a.allFinite()) << name(kind);
        EXPECT_EQ(a, extreme_positions(patch(), kind, 0.02, 0.1, 0.0, two)) << name(kind);
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(prediction_kind_count));
}

TEST(Predictions, FeasibleOnesAreWithinTheirLimits) {
    const Positions rest = patch();
    for (int seed = 1; seed <= 10; ++seed) {
        Random random(seed);
        const Positions r = extreme_positions(rest, PredictionKind::feasible, 0.02, 1.0, -0.1, random);
        for (int v = 0; v + 1 < 12; ++v)
            EXPECT_LE((r.row(v) - r.row(v + 1)).norm(), 0.9 * (rest.row(v) - rest.row(v + 1)).norm());
    }
}

}  // namespace
}  // namespace toile::evaluate

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "tests/prior/inextensible_cases.h"

namespace toile::prior::test {
namespace {

/// Two vertices and one edge of limit 2, k = (1, 3), predicted 4 apart. The solution takes 1.5 from the light end and
/// 0.5 from the heavy one, with λ = 1.5.
struct OneEdge {
    InextensibilityModel model;
    std::vector<double> predicted{0, 0, 0, 4, 0, 0};
    std::vector<double> position{1.5, 0, 0, 3.5, 0, 0};
    std::vector<double> multiplier{1.5};

    OneEdge() {
        model.vertex_count = 2;
        model.edge.resize(1, 2);
        model.edge << 0, 1;
        model.edge_max_length = Eigen::VectorXd::Constant(1, 2.0);
        model.target_stiffness = Eigen::Vector2d(1.0, 3.0);
    }
    double residual() const { return inextensibility_residual(model, predicted, position, multiplier); }
};

TEST(InextensibilityResidual, IsZeroAtTheSolution) {
    EXPECT_DOUBLE_EQ(OneEdge().residual(), 0.0);
}

TEST(InextensibilityResidual, MeasuresOverstretch) {
    OneEdge edge;
    edge.position[3] =
        3.7;  // l = 2.2: ten per cent over; the springs are now (1.5, -0.9), and 0.6 / 1.5 out of balance
    EXPECT_NEAR(edge.residual(), 0.4, 1e-12);
    edge.multiplier[0] = 0.0;
    edge.position = {0.0, 0, 0, 2.5, 0, 0};
    edge.predicted = edge.position;  // no force at all: only the overstretch counts
    EXPECT_NEAR(edge.residual(), 0.25, 1e-12);
}

TEST(InextensibilityResidual, MeasuresImbalance) {
    OneEdge edge;
    edge.multiplier[0] = 1.2;  // springs of 1.5 against a pull of 1.2, relative to s = 1.5
    EXPECT_NEAR(edge.residual(), 0.2, 1e-12);
}

TEST(InextensibilityResidual, MeasuresComplementarity) {
    OneEdge edge;
    // l = 1.6, a fifth below the limit; both springs carry 1.8.
    edge.position = {1.8, 0, 0, 3.4, 0, 0};
    edge.multiplier[0] = 1.8;
    EXPECT_NEAR(edge.residual(), 0.2, 1e-12);
}

TEST(InextensibilityResidual, MeasuresPushingEdges) {
    OneEdge edge;
    edge.predicted = {0, 0, 0, 1, 0, 0};
    edge.position = {-0.3, 0, 0, 1.1, 0, 0};
    edge.multiplier[0] = -0.3;  // an edge that pushes: in balance, s = 0.3
    EXPECT_NEAR(edge.residual(), 1.0, 1e-12);
}

TEST(InextensibilityResidual, IsZeroForAPredictionThatIsShortEnough) {
    OneEdge edge;
    edge.predicted = edge.position = {0, 0, 0, 1, 0, 0};
    edge.multiplier[0] = 0.0;
    EXPECT_EQ(edge.residual(), 0.0);
}

TEST(InextensibilityResidual, GivesAnEdgeWithoutLengthNoDirection) {
    OneEdge edge;
    edge.predicted = edge.position = {1, 1, 1, 1, 1, 1};
    edge.multiplier[0] = 1.0;  // s = 1: what is left is λ (l^max − 0) / (l^max s)
    EXPECT_DOUBLE_EQ(edge.residual(), 1.0);
    edge.multiplier[0] = 0.0;
    EXPECT_EQ(edge.residual(), 0.0);
}

TEST(InextensibilityResidual, DoesNotDependOnUnits) {
    OneEdge edge;
    edge.multiplier[0] = 1.2;
    const double in_metres = edge.residual();
    for (double& x : edge.predicted) x *= 1000;
    for (double& x : edge.position) x *= 1000;
    edge.model.edge_max_length *= 1000;
    edge.model.target_stiffness *= 1e-6;
    edge.multiplier[0] *= 1e-3;
    EXPECT_NEAR(edge.residual(), in_metres, 1e-12);
}

TEST(InextensibilityResidual, IsInfiniteWhereSomethingIsNotFinite) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    OneEdge edge;
    edge.position[4] = nan;
    EXPECT_EQ(edge.residual(), std::numeric_limits<double>::infinity());
    edge = OneEdge();
    edge.multiplier[0] = nan;
    EXPECT_EQ(edge.residual(), std::numeric_limits<double>::infinity());
    edge = OneEdge();
    edge.predicted[0] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(edge.residual(), std::numeric_limits<double>::infinity());
}

TEST(InextensibilityResidual, RefusesArraysThatDoNotFit) {
    OneEdge edge;
    edge.multiplier.push_back(0.0);
    EXPECT_THROW(edge.residual(), Error);
    edge = OneEdge();
    edge.position.pop_back();
    EXPECT_THROW(edge.residual(), Error);
}

TEST(InextensibilityResidual, AgreesWithDenseMatricesOnRandomPoints) {
    const InextensibleCase cloth = patch(4, 3, 0.02, 0.2);
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.01, seed);
        const std::vector<double> position = with_noise(cloth.at_rest(), 0.01, seed + 10);
        std::vector<double> multiplier =
            with_noise(std::vector<double>(cloth.model.edge.rows(), 0.005), 0.01, seed + 20);
        const double expected = dense_residual(cloth.model, predicted, position, multiplier);
        EXPECT_NEAR(inextensibility_residual(cloth.model, predicted, position, multiplier), expected, 1e-12 * expected);
    }
}

}  // namespace
}  // namespace toile::prior::test

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "prior/cone_derivative.h"
#include "prior/cone_solver.h"
#include "tests/prior/inextensible_cases.h"
#include "tests/prior/paper_cone_program.h"
#include "tests/support/derivative_checker.h"

namespace toile::prior::test {
namespace {

using toile::test::check_jacobian;

struct Solved {
    InextensibilityModel model;
    std::vector<double> predicted, position, multiplier;

    Solved(const InextensibilityModel& given, const std::vector<double>& at)
        : model(given), predicted(at), position(at.size()), multiplier(static_cast<size_t>(given.edge.rows())) {
        InextensibilityOptions options;
        options.tolerance = 1e-10;
        const Report report = ConeSolver(model).project(predicted, position, multiplier, options);
        EXPECT_LE(report.residual, 1e-8);
    }
    Eigen::Index coordinates() const { return 3 * model.vertex_count; }

    Eigen::VectorXd tangent(const Eigen::VectorXd& predicted_change, const Eigen::VectorXd& limit_change,
                            DerivativeReport* report = nullptr) const {
        Eigen::VectorXd change(coordinates());
        const DerivativeReport got = ConeSolver(model).tangent(
            position, multiplier, {predicted_change.data(), static_cast<size_t>(predicted_change.size())},
            {limit_change.data(), static_cast<size_t>(limit_change.size())},
            {change.data(), static_cast<size_t>(change.size())});
        if (report) *report = got;
        return change;
    }
    DerivativeReport backward(const Eigen::VectorXd& loss_gradient, Eigen::VectorXd& predicted_gradient,
                              Eigen::VectorXd& limit_gradient) const {
        predicted_gradient.resize(coordinates());
        limit_gradient.resize(model.edge.rows());
        return ConeSolver(model).backward(position, multiplier,
                                          {loss_gradient.data(), static_cast<size_t>(loss_gradient.size())},
                                          {predicted_gradient.data(), static_cast<size_t>(predicted_gradient.size())},
                                          {limit_gradient.data(), static_cast<size_t>(limit_gradient.size())});
    }
};

/// The dense system of method.md, Section 2, over the taut edges.
struct DenseKkt {
    Eigen::MatrixXd k, matrix;
    std::vector<int> taut;

    explicit DenseKkt(const Solved& at) {
        const Eigen::Index v = at.coordinates();
        const Eigen::Map<const Eigen::VectorXd> r(at.position.data(), v);
        taut = find_taut_edges(at.model, at.position, at.multiplier).edge;
        k = Eigen::MatrixXd::Zero(v, v);
        for (Eigen::Index i = 0; i < v; ++i) k(i, i) = at.model.target_stiffness[i / 3];
        matrix = Eigen::MatrixXd::Zero(v + taut.size(), v + taut.size());
        matrix.topLeftCorner(v, v) = k;
        for (size_t j = 0; j < taut.size(); ++j) {
            const int a = 3 * at.model.edge(taut[j], 0), b = 3 * at.model.edge(taut[j], 1);
            const Eigen::Vector3d vector = r.segment<3>(a) - r.segment<3>(b), n = vector.normalized();
            const Eigen::Matrix3d block =
                at.multiplier[taut[j]] / vector.norm() * (Eigen::Matrix3d::Identity() - n * n.transpose());
            matrix.block<3, 3>(a, a) += block;
            matrix.block<3, 3>(b, b) += block;
            matrix.block<3, 3>(a, b) -= block;
            matrix.block<3, 3>(b, a) -= block;
            const Eigen::Index row = v + static_cast<Eigen::Index>(j);
            matrix.block<1, 3>(row, a) = n.transpose();
            matrix.block<1, 3>(row, b) = -n.transpose();
            matrix.block<3, 1>(a, row) = n;
            matrix.block<3, 1>(b, row) = -n;
        }
    }
    Eigen::VectorXd solve(const Eigen::VectorXd& top) const {
        Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix.rows());
        right.head(top.size()) = top;
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
        decomposition.setThreshold(1e-9);  // multipliers and directions are known to about 1e-10
        decomposition.compute(matrix);
        return decomposition.solve(right);
    }
};

Eigen::VectorXd random_values(Eigen::Index size, unsigned seed) {
    const std::vector<double> values = random_vector(static_cast<size_t>(size), seed);
    return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

Solved noisy_patch(int columns, int rows, unsigned seed) {
    InextensibleCase cloth = patch(columns, rows, 0.02, 0.2, seed);
    for (int i = 0; i < cloth.model.vertex_count; ++i) cloth.model.target_stiffness[i] = 1.0 + 0.5 * (i % 3);
    return {cloth.model, with_noise(cloth.at_rest(), 0.01, seed)};
}

void expect_dense_reference(const Solved& at, double tolerance) {
    const DenseKkt dense(at);
    const Eigen::VectorXd gradient = random_values(at.coordinates(), 5), expected = dense.solve(gradient);
    Eigen::VectorXd by_predicted, by_limit;
    const DerivativeReport report = at.backward(gradient, by_predicted, by_limit);
    EXPECT_EQ(report.status, Status::converged) << report.linear_residual;
    EXPECT_LT((by_predicted - dense.k * expected.head(at.coordinates())).norm(), tolerance * by_predicted.norm());
    Eigen::VectorXd expected_by_limit = Eigen::VectorXd::Zero(at.model.edge.rows());
    for (size_t j = 0; j < dense.taut.size(); ++j)
        expected_by_limit[dense.taut[j]] = expected[at.coordinates() + static_cast<Eigen::Index>(j)];
    EXPECT_LT((by_limit - expected_by_limit).norm(), tolerance * by_limit.norm());
}

/// The Jacobian of r* by (r̂, limits), column by column.
Eigen::MatrixXd jacobian_of(const Solved& at) {
    const Eigen::Index v = at.coordinates(), edges = at.model.edge.rows();
    Eigen::MatrixXd jacobian(v, v + edges);
    for (Eigen::Index i = 0; i < v; ++i)
        jacobian.col(i) = at.tangent(Eigen::VectorXd::Unit(v, i), Eigen::VectorXd::Zero(edges));
    for (Eigen::Index e = 0; e < edges; ++e)
        jacobian.col(v + e) = at.tangent(Eigen::VectorXd::Zero(v), Eigen::VectorXd::Unit(edges, e));
    return jacobian;
}

Eigen::VectorXd input_of(const Solved& at) {
    Eigen::VectorXd input(at.coordinates() + at.model.edge.rows());
    input << Eigen::Map<const Eigen::VectorXd>(at.predicted.data(), at.coordinates()), at.model.edge_max_length;
    return input;
}

Eigen::VectorXd project_at(const Solved& at, const Eigen::VectorXd& input) {
    InextensibilityModel model = at.model;
    model.edge_max_length = input.tail(model.edge.rows());
    const Solved moved(model, {input.data(), input.data() + at.coordinates()});
    return Eigen::Map<const Eigen::VectorXd>(moved.position.data(), at.coordinates());
}

TEST(ConeDerivative, FindsTautEdgesByForceAgainstSlack) {
    // Four edges of limit 1 in a row: taut, nearly taut with a clear force, loose with a trace of force, without both.
    Positions rest(5, 3);
    for (int i = 0; i < 5; ++i) rest.row(i) << i, 0, 0;
    const InextensibleCase chain = case_of(rest, {{0, 1}, {1, 2}, {2, 3}, {3, 4}});
    const std::vector<double> position{0, 0, 0, 1, 0, 0, 1.999, 0, 0, 2.9, 0, 0, 3.9, 0, 0};
    const TautEdges taut = find_taut_edges(chain.model, position, std::vector<double>{2.0, 0.1, 1e-4, 0.0});
    EXPECT_EQ(taut.edge, (std::vector<int>{0, 1}));
    EXPECT_EQ(taut.weakly_active, 1);
    EXPECT_NEAR(taut.distance, 0.0, 1e-12);
    const TautEdges without_last = find_taut_edges(chain.model, position, std::vector<double>{2.0, 0.1, 1e-4, 1.0});
    EXPECT_EQ(without_last.weakly_active, 0);
    EXPECT_NEAR(without_last.distance, 0.05, 1e-12);
}

TEST(ConeDerivative, AgreesWithFiniteDifferencesOfTheWholeMap) {
    const Solved at = noisy_patch(2, 2, 3);
    const Eigen::VectorXd input = input_of(at);
    const auto check =
        check_jacobian([&](const Eigen::VectorXd& x) { return project_at(at, x); }, jacobian_of(at), input, 0.02, 1e-7);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(ConeDerivative, AgreesWithFiniteDifferencesAlongRandomDirections) {
    for (auto [columns, rows, seed] : {std::tuple{3, 3, 1u}, {5, 4, 2u}, {8, 8, 4u}}) {
        const Solved at = noisy_patch(columns, rows, seed);
        const Eigen::VectorXd input = input_of(at);
        Eigen::MatrixXd direction(input.size(), 2), along(at.coordinates(), 2);
        for (int k = 0; k < 2; ++k) {
            direction.col(k) = random_values(input.size(), 20 + k);
            along.col(k) =
                at.tangent(direction.col(k).head(at.coordinates()), direction.col(k).tail(at.model.edge.rows()));
        }
        const auto check =
            check_jacobian([&](const Eigen::VectorXd& x) { return project_at(at, input + direction * x); }, along,
                           Eigen::VectorXd::Zero(2), 0.02, 1e-7);
        EXPECT_TRUE(check.passed) << columns << " x " << rows << ": " << check.message;
    }
}

TEST(ConeDerivative, ProductsAreTransposesOfEachOther) {
    for (const Solved& at : {noisy_patch(3, 3, 1), noisy_patch(7, 6, 2), noisy_patch(12, 12, 3)}) {
        const Eigen::VectorXd predicted_change = random_values(at.coordinates(), 6),
                              limit_change = random_values(at.model.edge.rows(), 7),
                              gradient = random_values(at.coordinates(), 8);
        DerivativeReport report;
        const Eigen::VectorXd change = at.tangent(predicted_change, limit_change, &report);
        EXPECT_EQ(report.status, Status::converged) << report.linear_residual;
        Eigen::VectorXd by_predicted, by_limit;
        EXPECT_EQ(at.backward(gradient, by_predicted, by_limit).status, Status::converged);
        const double forward = gradient.dot(change);
        const double backward = by_predicted.dot(predicted_change) + by_limit.dot(limit_change);
        EXPECT_NEAR(forward, backward, 1e-9 * gradient.norm() * change.norm());
    }
}

TEST(ConeDerivative, AgreesWithADenseReference) {
    expect_dense_reference(noisy_patch(3, 3, 1), 1e-9);
    expect_dense_reference(noisy_patch(6, 5, 2), 1e-9);
}

TEST(ConeDerivative, HoldsForStiffnessesAndForcesFarApart) {
    InextensibleCase cloth = patch(5, 4, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.02);
    std::vector<double> with_outlier = predicted;
    with_outlier[4] += 100.0;
    std::vector<Solved> cases{{cloth.model, with_outlier}};
    for (int i = 0; i < cloth.model.vertex_count; ++i) cloth.model.target_stiffness[i] = std::pow(10.0, i % 7 - 3);
    cases.emplace_back(cloth.model, predicted);
    for (const Solved& at : cases) {
        const Eigen::VectorXd predicted_change = random_values(at.coordinates(), 6),
                              limit_change = random_values(at.model.edge.rows(), 7),
                              gradient = random_values(at.coordinates(), 8);
        DerivativeReport report;
        const Eigen::VectorXd change = at.tangent(predicted_change, limit_change, &report);
        EXPECT_EQ(report.status, Status::converged) << report.linear_residual;
        Eigen::VectorXd by_predicted, by_limit;
        EXPECT_EQ(at.backward(gradient, by_predicted, by_limit).status, Status::converged);
        EXPECT_NEAR(gradient.dot(change), by_predicted.dot(predicted_change) + by_limit.dot(limit_change),
                    1e-9 * gradient.norm() * change.norm());
    }
}

TEST(ConeDerivative, IsThatOfThePapersEquation7) {
    const Solved at = noisy_patch(3, 2, 1);
    const Eigen::VectorXd predicted_change = random_values(at.coordinates(), 9);
    const Eigen::VectorXd limit_change = 0.1 * random_values(at.model.edge.rows(), 10);
    const PaperConeProgram paper(at.model, at.predicted, at.position, at.multiplier);
    const Eigen::VectorXd expected = paper.position_change(at.model, predicted_change, limit_change);
    EXPECT_LT((at.tangent(predicted_change, limit_change) - expected).norm(), 1e-8 * expected.norm());
}

TEST(ConeDerivative, TurnsAndShortensOneEdge) {
    // For one edge of limit L predicted d apart: the difference follows r̂ across the edge by L / d and not along it; a
    // longer limit moves the ends apart by their compliance.
    Positions rest(2, 3);
    rest << 0, 0, 0, 2, 0, 0;
    InextensibleCase edge = case_of(rest, {{0, 1}});
    edge.model.target_stiffness << 1, 3;
    const Solved at(edge.model, {0, 0, 0, 4, 0, 0});
    Eigen::VectorXd predicted_change(6), expected(6);
    predicted_change << 0, 0, 0, 1, 1, 0;
    expected << 0.75, 0.375, 0, 0.75, 0.875, 0;  // the centre of mass moves by 3/4 of it
    EXPECT_LT((at.tangent(predicted_change, Eigen::VectorXd::Zero(1)) - expected).norm(), 1e-10);
    expected << -0.75, 0, 0, 0.25, 0, 0;
    EXPECT_LT((at.tangent(Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(1)) - expected).norm(), 1e-10);
}

TEST(ConeDerivative, IsTheIdentityWhereNoEdgeIsTaut) {
    const InextensibleCase cloth = patch(3, 3);
    std::vector<double> predicted = cloth.at_rest();
    for (double& x : predicted) x *= 0.5;
    const Solved at(cloth.model, predicted);
    const Eigen::VectorXd gradient = random_values(at.coordinates(), 11);
    Eigen::VectorXd by_predicted, by_limit;
    const DerivativeReport report = at.backward(gradient, by_predicted, by_limit);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_EQ(report.taut_edges, 0);
    EXPECT_EQ(report.weakly_active, 0);
    EXPECT_NEAR(report.active_set_distance, 0.5, 1e-12);
    EXPECT_LT((by_predicted - gradient).norm(), 1e-14 * gradient.norm());
    EXPECT_EQ(by_limit.norm(), 0.0);
}

TEST(ConeDerivative, CountsEdgesThatAreTautWithoutForce) {
    const InextensibleCase cloth = patch(3, 3);
    const Solved at(cloth.model, cloth.at_rest());  // every edge exactly at its limit
    const Eigen::VectorXd gradient = random_values(at.coordinates(), 12);
    Eigen::VectorXd by_predicted, by_limit;
    const DerivativeReport report = at.backward(gradient, by_predicted, by_limit);
    EXPECT_EQ(report.weakly_active, cloth.model.edge.rows());
    EXPECT_EQ(report.taut_edges, 0);
    EXPECT_LT(report.active_set_distance, 1e-12);
    EXPECT_LT((by_predicted - gradient).norm(), 1e-14 * gradient.norm());
}

TEST(ConeDerivative, TakesTheSmallestNormOnThePapersTriangle) {
    Positions rest(3, 3);
    rest << -1, 0, 0, 0, 0, 0, 1, 0, 0;
    const InextensibleCase triangle = case_of(rest, {{0, 1}, {1, 2}, {0, 2}});
    const Solved at(triangle.model, {-2, 0, 0, 0, 0, 0, 2, 0, 0});
    expect_dense_reference(at, 1e-9);

    // Along the line the three vertices move as one, and three multipliers share what two constraints ask for.
    const Eigen::VectorXd gradient = Eigen::VectorXd::Unit(9, 0);
    Eigen::VectorXd by_predicted, by_limit;
    at.backward(gradient, by_predicted, by_limit);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(by_predicted[3 * i], 1.0 / 3.0, 1e-9);
    EXPECT_NEAR(by_limit[0], -1.0 / 3.0, 1e-8);
    EXPECT_NEAR(by_limit[1], 0.0, 1e-8);
    EXPECT_NEAR(by_limit[2], -1.0 / 3.0, 1e-8);
    // The null direction of Figure 11, (1, 1, −1), has no part in it.
    EXPECT_NEAR(by_limit.dot(Eigen::Vector3d(1, 1, -1)), 0.0, 1e-8);
}

TEST(ConeDerivative, TakesTheSmallestNormOnFlatTautRegions) {
    for (int side : {2, 3, 5, 8}) {
        const InextensibleCase cloth = patch(side, side);
        std::vector<double> predicted = cloth.at_rest();
        for (double& x : predicted) x *= 1.3;
        const Solved at(cloth.model, predicted);
        SCOPED_TRACE(side);
        expect_dense_reference(at, 1e-6);
        const Eigen::VectorXd predicted_change = random_values(at.coordinates(), 13),
                              limit_change = random_values(at.model.edge.rows(), 14),
                              gradient = random_values(at.coordinates(), 15);
        DerivativeReport report;
        const Eigen::VectorXd change = at.tangent(predicted_change, limit_change, &report);
        EXPECT_EQ(report.status, Status::converged) << report.linear_residual;
        Eigen::VectorXd by_predicted, by_limit;
        at.backward(gradient, by_predicted, by_limit);
        EXPECT_NEAR(gradient.dot(change), by_predicted.dot(predicted_change) + by_limit.dot(limit_change),
                    1e-9 * gradient.norm() * change.norm());
    }
}

TEST(ConeDerivative, RejectsWhatIsNotFinite) {
    const InextensibleCase cloth = patch(3, 3);
    Solved at = noisy_patch(3, 3, 1);
    at.position.assign(at.position.size(), std::numeric_limits<double>::quiet_NaN());
    Eigen::VectorXd by_predicted, by_limit;
    const DerivativeReport report = at.backward(random_values(at.coordinates(), 1), by_predicted, by_limit);
    EXPECT_EQ(report.status, Status::rejected_input);
    EXPECT_TRUE(by_predicted.array().isNaN().all());
    EXPECT_TRUE(by_limit.array().isNaN().all());
}

}  // namespace
}  // namespace toile::prior::test

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "prior/inextensibility_derivative.h"
#include "tests/prior/inextensible_cases.h"
#include "tests/support/derivative_checker.h"

namespace toile::prior::test {
namespace {

using toile::test::check_jacobian;

InextensibilityOptions precise(double tolerance = 1e-10) {
    InextensibilityOptions options;
    options.tolerance = tolerance;
    return options;
}

/// One sample, or `copies` of it side by side.
struct Projected {
    InextensibilityModel model;
    Inextensibility prior;
    Inextensibility::Workspace workspace;
    InextensibilitySolution solution;
    int copies;

    Projected(const InextensibilityModel& given, const std::vector<double>& predicted, int count = 1,
              const InextensibilityOptions& options = precise())
        : model(given), prior(given, options), workspace(prior), copies(count) {
        std::vector<double> all;
        for (int c = 0; c < copies; ++c) all.insert(all.end(), predicted.begin(), predicted.end());
        prior.project(all, solution, workspace);
    }
    Eigen::Index coordinates() const { return 3 * model.vertex_count; }

    Eigen::VectorXd tangent(const Eigen::VectorXd& predicted_change, const Eigen::VectorXd& limit_change) {
        const Eigen::VectorXd p = predicted_change.replicate(copies, 1), l = limit_change.replicate(copies, 1);
        InextensibilityTangent result;
        prior.tangent(solution, {p.data(), static_cast<std::size_t>(p.size())},
                      {l.data(), static_cast<std::size_t>(l.size())}, result, workspace);
        report = result.report.back();
        return Eigen::Map<const Eigen::VectorXd>(result.position.data() + (copies - 1) * coordinates(), coordinates());
    }
    InextensibilityGradient backward(const Eigen::VectorXd& loss_gradient) {
        const Eigen::VectorXd g = loss_gradient.replicate(copies, 1);
        InextensibilityGradient gradient;
        prior.backward(solution, {g.data(), static_cast<std::size_t>(g.size())}, gradient, workspace);
        report = gradient.report.back();
        return gradient;
    }
    DerivativeReport report;
};

Eigen::VectorXd as_vector(const std::vector<double>& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}
std::vector<double> as_list(const Eigen::VectorXd& x) {
    return {x.data(), x.data() + x.size()};
}

Eigen::VectorXd project(const InextensibilityModel& model, const Eigen::VectorXd& predicted) {
    return as_vector(Projected(model, as_list(predicted)).solution.position);
}

/// The Jacobian of r* by r̂, from one Jacobian-vector product for each column.
Eigen::MatrixXd jacobian(Projected& at) {
    Eigen::MatrixXd result(at.coordinates(), at.coordinates());
    for (Eigen::Index i = 0; i < at.coordinates(); ++i)
        result.col(i) = at.tangent(Eigen::VectorXd::Unit(at.coordinates(), i), {});
    return result;
}

TEST(InextensibilityDerivative, MatchesFiniteDifferencesInThePrediction) {
    for (const auto& [columns, rows, noise] : {std::tuple{2, 2, 0.3}, {3, 3, 0.1}, {5, 4, 0.2}}) {
        const InextensibleCase c = patch(columns, rows, 1.0, 0.2);
        const std::vector<double> predicted = with_noise(c.at_rest(), noise, 3);
        Projected at(c.model, predicted);
        const auto check = check_jacobian([&](const Eigen::VectorXd& p) { return project(c.model, p); }, jacobian(at),
                                          as_vector(predicted), 1.0, 1e-5);
        EXPECT_TRUE(check.passed) << columns << " x " << rows << ": " << check.message << ", distance to a kink "
                                  << at.report.active_set_distance;
        EXPECT_GT(at.report.taut_edges, 0);
        EXPECT_EQ(at.report.status, Status::converged);
    }
}

TEST(InextensibilityDerivative, MatchesFiniteDifferencesInTheLimits) {
    const InextensibleCase c = patch(4, 3, 1.0, 0.2);
    const std::vector<double> predicted = with_noise(c.at_rest(), 0.2, 3);
    Projected at(c.model, predicted);
    const Eigen::Index edges = c.model.edge.rows();
    Eigen::MatrixXd by_limit(at.coordinates(), edges);
    for (Eigen::Index e = 0; e < edges; ++e)
        by_limit.col(e) = at.tangent(Eigen::VectorXd::Zero(at.coordinates()), Eigen::VectorXd::Unit(edges, e));
    const auto check = check_jacobian(
        [&](const Eigen::VectorXd& limit) {
            InextensibilityModel model = c.model;
            model.edge_max_length = limit;
            return project(model, as_vector(predicted));
        },
        by_limit, c.model.edge_max_length, 1.0, 1e-5);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(InextensibilityDerivative, ItsTwoProductsAreTransposes) {
    for (int copies : {1, 3})
        for (unsigned seed = 0; seed < 4; ++seed) {
            const InextensibleCase c = patch(8, 7, 0.02, 0.2, seed);
            Projected at(c.model, with_noise(c.at_rest(), 0.003 * (1 + seed), seed), copies, precise(1e-6));
            const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 7 + seed));
            const Eigen::VectorXd p = as_vector(random_vector(at.coordinates(), 17 + seed));
            const InextensibilityGradient gradient = at.backward(g);
            // Limits change along a change of lengths that positions can follow: with redundant taut edges others
            // cannot be met.
            const Eigen::VectorXd change = at.tangent(p, Eigen::VectorXd::Zero(c.model.edge.rows()));
            const double one = g.dot(change), two = as_vector(gradient.predicted).tail(at.coordinates()).dot(p);
            EXPECT_NEAR(one, two, 1e-9 * std::max(std::abs(one), std::abs(two)));
        }
}

/// Dense system of method.md, Section 2, over the edges with a multiplier.
struct Dense {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd stiffness;
    std::vector<int> taut;

    explicit Dense(const Projected& at) {
        const InextensibilityModel& m = at.model;
        const Eigen::VectorXd r = as_vector(at.solution.position), lambda = as_vector(at.solution.multiplier);
        for (int e = 0; e < m.edge.rows(); ++e)
            if (lambda[e] > 1e-6 * lambda.maxCoeff()) taut.push_back(e);
        const Eigen::Index n = at.coordinates(), a = static_cast<Eigen::Index>(taut.size());
        matrix = Eigen::MatrixXd::Zero(n + a, n + a);
        stiffness.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) matrix(i, i) = stiffness[i] = m.target_stiffness[i / 3];
        for (Eigen::Index t = 0; t < a; ++t) {
            const int i = 3 * m.edge(taut[t], 0), j = 3 * m.edge(taut[t], 1);
            const Eigen::Vector3d d = r.segment<3>(i) - r.segment<3>(j), u = d.normalized();
            const Eigen::Matrix3d block =
                lambda[taut[t]] / d.norm() * (Eigen::Matrix3d::Identity() - u * u.transpose());
            matrix.block<3, 3>(i, i) += block;
            matrix.block<3, 3>(j, j) += block;
            matrix.block<3, 3>(i, j) -= block;
            matrix.block<3, 3>(j, i) -= block;
            matrix.block<1, 3>(n + t, i) = u.transpose();
            matrix.block<1, 3>(n + t, j) = -u.transpose();
        }
        matrix.topRightCorner(n, a) = matrix.bottomLeftCorner(a, n).transpose();
    }
};

TEST(InextensibilityDerivative, MatchesADenseReferenceOfMinimalNorm) {
    for (double noise : {0.05, 0.3}) {
        const InextensibleCase c = patch(5, 4, 1.0, 0.2);
        Projected at(c.model, with_noise(c.at_rest(), noise, 5), 2);
        const Dense dense(at);
        const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 2));
        Eigen::VectorXd right = Eigen::VectorXd::Zero(dense.matrix.rows());
        right.head(g.size()) = g;
        const Eigen::VectorXd x = dense.matrix.completeOrthogonalDecomposition().solve(right);
        const InextensibilityGradient gradient = at.backward(g);
        const Eigen::VectorXd wanted = dense.stiffness.cwiseProduct(x.head(g.size()));
        EXPECT_LT((as_vector(gradient.predicted).tail(g.size()) - wanted).norm(), 1e-7 * wanted.norm());
        EXPECT_EQ(at.report.taut_edges, static_cast<int>(dense.taut.size()));
        const Eigen::Index edges = c.model.edge.rows();
        for (std::size_t t = 0; t < dense.taut.size(); ++t)
            EXPECT_NEAR(gradient.edge_max_length[edges + dense.taut[t]], x[g.size() + t], 1e-6 * x.norm());
    }
}

/// The paper's Figure 11: three vertices in a row, every pair joined, the long edge as long as the two short ones.
/// Pulled apart all three are taut, and their directions have rank two.
TEST(InextensibilityDerivative, OfDegenerateTautEdgesIsOfMinimalNorm) {
    InextensibilityModel model;
    model.vertex_count = 3;
    model.edge.resize(3, 2);
    model.edge << 0, 1, 1, 2, 0, 2;
    model.edge_max_length = Eigen::Vector3d(1, 1, 2);
    model.target_stiffness = Eigen::Vector3d::Ones();
    Projected at(model, {-2, 0, 0, 0, 0, 0, 2, 0, 0});
    const Eigen::VectorXd along = (Eigen::VectorXd(9) << 1, 0, 0, 0, 0, 0, -1, 0, 0).finished();
    const InextensibilityGradient gradient = at.backward(along);
    EXPECT_EQ(at.report.taut_edges, 3);
    EXPECT_LT(at.report.linear_residual, 1e-9);
    // Drawing the ends together is what the taut edges forbid to have an effect.
    EXPECT_LT(as_vector(gradient.predicted).norm(), 1e-6);
    // b of minimal norm with b_01 + b_02 = 1, b_12 + b_02 = 1 (in size): (1, 1, 2) / 3.
    EXPECT_NEAR(std::abs(gradient.edge_max_length[0]), 1.0 / 3, 1e-5);
    EXPECT_NEAR(std::abs(gradient.edge_max_length[1]), 1.0 / 3, 1e-5);
    EXPECT_NEAR(std::abs(gradient.edge_max_length[2]), 2.0 / 3, 1e-5);
    // Moving all three sideways together passes through.
    const Eigen::VectorXd sideways = (Eigen::VectorXd(9) << 0, 1, 0, 0, 1, 0, 0, 1, 0).finished();
    EXPECT_LT((as_vector(at.backward(sideways).predicted) - sideways).norm(), 1e-6);
}

TEST(InextensibilityDerivative, OfAStretchedFlatSheetStaysUnique) {
    const InextensibleCase c = patch(5, 5, 1.0);
    std::vector<double> predicted = c.at_rest();
    for (double& x : predicted) x *= 1.2;
    Projected at(c.model, predicted);
    const Dense dense(at);
    const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 2));
    Eigen::VectorXd right = Eigen::VectorXd::Zero(dense.matrix.rows());
    right.head(g.size()) = g;
    const Eigen::VectorXd wanted = dense.matrix.completeOrthogonalDecomposition().solve(right).head(g.size());
    const InextensibilityGradient gradient = at.backward(g);
    EXPECT_EQ(at.report.taut_edges, static_cast<int>(dense.taut.size()));
    EXPECT_LT((as_vector(gradient.predicted) - wanted).norm(), 1e-6 * g.norm());
}

TEST(InextensibilityDerivative, WithoutTautEdgesIsTheIdentity) {
    const InextensibleCase c = patch(4, 4);
    std::vector<double> predicted = c.at_rest();
    for (double& x : predicted) x *= 0.8;
    Projected at(c.model, predicted);
    const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 2));
    EXPECT_LT((as_vector(at.backward(g).predicted) - g).norm(), 1e-14 * g.norm());
    EXPECT_EQ(at.report.taut_edges, 0);
    EXPECT_EQ(at.report.weakly_active, 0);
    EXPECT_NEAR(at.report.active_set_distance, 0.2, 1e-9);
}

TEST(InextensibilityDerivative, ReportsEdgesAtTheirLimitWithoutForce) {
    const InextensibleCase c = patch(4, 4);
    Projected at(c.model, c.at_rest());
    const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 2));
    const InextensibilityGradient gradient = at.backward(g);
    EXPECT_EQ(at.report.weakly_active, static_cast<int>(c.model.edge.rows()));
    EXPECT_EQ(at.report.taut_edges, 0);
    EXPECT_NEAR(at.report.active_set_distance, 0.0, 1e-12);
    EXPECT_LT((as_vector(gradient.predicted) - g).norm(), 1e-12 * g.norm()) << "taken as free";
}

TEST(InextensibilityDerivative, OfARejectedSampleIsNotANumber) {
    const InextensibleCase c = patch(4, 3);
    const std::size_t size = c.at_rest().size();
    std::vector<double> predicted = with_noise(c.at_rest(), 0.01);
    const std::vector<double> good = predicted;
    predicted[4] = NAN;
    predicted.insert(predicted.end(), good.begin(), good.end());
    const Inextensibility prior(c.model);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    prior.project(predicted, solution, workspace);
    InextensibilityGradient gradient;
    prior.backward(solution, std::vector<double>(2 * size, 1.0), gradient, workspace);
    EXPECT_EQ(gradient.report[0].status, Status::rejected_input);
    EXPECT_TRUE(std::isnan(gradient.predicted[0]));
    EXPECT_EQ(gradient.report[1].status, Status::converged);
    EXPECT_TRUE(std::isfinite(gradient.predicted[size]));
}

TEST(InextensibilityDerivative, LeavesTheSolutionAsItIsAndRepeatsItself) {
    const InextensibleCase c = patch(6, 5, 0.02, 0.2);
    Projected at(c.model, with_noise(c.at_rest(), 0.01), 3);
    const InextensibilitySolution before = at.solution;
    const Eigen::VectorXd g = as_vector(random_vector(at.coordinates(), 2));
    const InextensibilityGradient first = at.backward(g), second = at.backward(g);
    EXPECT_EQ(first.predicted, second.predicted);
    EXPECT_EQ(before.position, at.solution.position);
    EXPECT_EQ(before.multiplier, at.solution.multiplier);
}

}  // namespace
}  // namespace toile::prior::test

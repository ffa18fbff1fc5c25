#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "prior/incomplete_cholesky.h"
#include "prior/linear_sweeps.h"
#include "prior/one_sample.h"
#include "prior/single_preconditioners.h"
#include "prior/spring_graph.h"
#include "prior/spring_lanes.h"
#include "tests/prior/quasistatic_cases.h"
#include "tests/support/derivative_checker.h"

namespace toile::prior::test {
namespace {

/// A sheet's springs and positions in the graph's numbering and units.
struct Springs {
    QuasistaticModel model;
    SpringGraph graph;
    Eigen::VectorXd predicted, position;

    explicit Springs(double noise, double mu = 0.1)
        : model(QuasistaticModel::from(rest_state(sheet(4, 4)), {}, mu)), graph(model) {
        predicted = in_graph(draped(sheet(4, 4)));
        position = in_graph(noisy(draped(sheet(4, 4)), noise));
    }
    Eigen::VectorXd in_graph(const std::vector<double>& from) const {
        Eigen::VectorXd to(from.size());
        for (Eigen::Index i = 0; i < to.size(); ++i)
            to[i] = from[static_cast<size_t>(3 * graph.vertex[i / 3] + i % 3)] / graph.length_unit;
        return to;
    }
    Eigen::VectorXd in_model(const Eigen::VectorXd& from) const {
        Eigen::VectorXd to(from.size());
        for (Eigen::Index i = 0; i < to.size(); ++i) to[3 * graph.vertex[i / 3] + i % 3] = from[i] * graph.length_unit;
        return to;
    }
    SpringValue<1> evaluate(const Eigen::VectorXd& at, Eigen::VectorXd& gradient) const {
        gradient.resize(at.size());
        SpringValue<1> value;
        evaluate_springs<1>(graph, at.data(), predicted.data(), gradient.data(), value);
        return value;
    }
    Eigen::MatrixXd hessian(double exact) const {
        std::vector<double> form(4 * graph.spring.size()), diagonal(2 * position.size());
        linearize_springs<1>(graph, position.data(), &exact, &exact, form.data(), diagonal.data());
        Eigen::MatrixXd result(position.size(), position.size());
        double curvature, squared;
        for (Eigen::Index i = 0; i < position.size(); ++i) {
            const Eigen::VectorXd unit = Eigen::VectorXd::Unit(position.size(), i);
            multiply_springs<1>(graph, form.data(), unit.data(), result.col(i).data(), &curvature, &squared);
            EXPECT_NEAR(curvature, result(i, i), 1e-12 * std::abs(curvature));
            Eigen::VectorXd straight(position.size());
            multiply_hessian<1>(graph, position.data(), &exact, unit.data(), straight.data());
            EXPECT_LT((straight - result.col(i)).norm(), 1e-12 * straight.norm());
        }
        return result;
    }
};

TEST(SpringGraph, HasTheModelsEnergy) {
    const Springs s(0.004);
    Eigen::VectorXd gradient;
    const double unit = s.graph.stiffness_unit * s.graph.length_unit * s.graph.length_unit;
    const Eigen::VectorXd other = 1.1 * s.position + Eigen::VectorXd::LinSpaced(48, 0.0, 0.1);
    // Merged springs leave a constant out.
    const double difference = s.evaluate(s.position, gradient).energy[0] - s.evaluate(other, gradient).energy[0];
    const Eigen::VectorXd r_hat = s.in_model(s.predicted);
    const double expected =
        dense_energy(s.model, r_hat, s.in_model(s.position)) - dense_energy(s.model, r_hat, s.in_model(other));
    EXPECT_NEAR(unit * difference / expected, 1.0, 1e-10);
}

TEST(SpringGraph, GradientIsTheEnergysDerivative) {
    const Springs s(0.006);
    Eigen::VectorXd gradient, unused;
    const SpringValue<1> value = s.evaluate(s.position, gradient);
    EXPECT_EQ(value.largest[0], gradient.cwiseAbs().maxCoeff());
    const auto energy = [&](const Eigen::VectorXd& x) { return s.evaluate(x, unused).energy[0]; };
    const auto check = toile::test::check_gradient(energy, gradient, s.position, 1.0, 1e-7);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(SpringGraph, HessianIsTheGradientsDerivative) {
    const Springs s(0.006);
    const auto gradient = [&](const Eigen::VectorXd& x) {
        Eigen::VectorXd g;
        s.evaluate(x, g);
        return g;
    };
    const auto check = toile::test::check_jacobian(gradient, s.hessian(1.0), s.position, 1.0, 1e-7);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(SpringGraph, ProjectedHessianIsPositiveDefinite) {
    Springs s(0.001, 1e-3);
    s.position *= 0.8;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> exact(s.hessian(1.0)), projected(s.hessian(0.0));
    EXPECT_LT(exact.eigenvalues()[0], 0.0) << "the case shows nothing";
    EXPECT_GT(projected.eigenvalues()[0], 0.0);
}

template <int W>
Eigen::VectorXd apply(Preconditioner<W>& preconditioner, const Springs& s, double exact, const Eigen::VectorXd& r) {
    LaneArray form(4 * W * s.graph.spring.size()), diagonal(6 * W * 16), at(48 * W), right(48 * W), out(48 * W);
    alignas(64) double exact_lanes[W], lost[W], sum[W];
    std::fill_n(exact_lanes, W, exact);
    for (int i = 0; i < 48; ++i)
        for (int l = 0; l < W; ++l) {
            at[static_cast<size_t>(i) * W + l] = s.position[i];
            right[static_cast<size_t>(i) * W + l] = r[i];
        }
    linearize_springs<W>(s.graph, at.data(), exact_lanes, exact_lanes, form.data(), diagonal.data());
    preconditioner.factor(form.data(), diagonal.data(), exact_lanes, lost);
    preconditioner.solve(right.data(), out.data(), sum);
    Eigen::VectorXd z(48);
    for (int i = 0; i < 48; ++i) z[i] = out[static_cast<size_t>(i) * W + W - 1];
    EXPECT_NEAR(sum[W - 1], r.dot(z), 1e-9 * std::abs(sum[W - 1]));
    return z;
}

TEST(SpringGraph, PreconditionersComeNearTheInverse) {
    const Springs s(0.004);
    const Eigen::VectorXd r = s.hessian(0.0) * Eigen::VectorXd::LinSpaced(48, -1.0, 2.0);
    const Eigen::VectorXd exact = Eigen::VectorXd::LinSpaced(48, -1.0, 2.0);
    CompleteCholesky complete(s.graph);
    EXPECT_LT((apply<1>(complete, s, 0.0, r) - exact).norm(), 1e-9 * exact.norm());
    IncompleteCholesky<1> incomplete(s.graph);
    const Eigen::VectorXd near = apply<1>(incomplete, s, 0.0, r);
    EXPECT_LT((near - exact).norm(), 0.5 * exact.norm());
    IncompleteCholesky<8> eight(s.graph);
    // Eight lanes keep eight bits of the factor.
    EXPECT_LT((apply<8>(eight, s, 0.0, r) - near).norm(), 0.03 * near.norm());
    BlockJacobi jacobi(s.graph);
    EXPECT_GT(r.dot(apply<1>(jacobi, s, 0.0, r)), 0.0);
}

TEST(SpringGraph, SweepsOfOneSampleAreThoseOfEight) {
    const Springs s(0.004);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(48, -1.0, 2.0);
    const auto first_steps = [&]<int W>(LinearSweeps<W>& sweeps) {
        LaneArray at(48 * W), right(48 * W), out(48 * W);
        alignas(64) double exact[W], lost[W], r_dot_z[W], squared[W], largest[W], curvature[W], length[W], turn[W];
        std::fill_n(exact, W, 0.0);
        for (size_t i = 0; i < 48 * W; ++i) {
            at[i] = s.position[static_cast<Eigen::Index>(i / W)];
            right[i] = b[static_cast<Eigen::Index>(i / W)];
        }
        sweeps.linearize(at.data(), exact, exact);
        sweeps.factor(exact, lost);
        sweeps.begin(right.data(), r_dot_z, squared, largest);
        for (int k = 0; k < 3; ++k) {
            sweeps.multiply(curvature);
            for (int l = 0; l < W; ++l) length[l] = r_dot_z[l] / curvature[l];
            sweeps.advance(length, squared, largest);
            std::copy_n(r_dot_z, W, turn);
            sweeps.condition(r_dot_z);
            for (int l = 0; l < W; ++l) turn[l] = r_dot_z[l] / turn[l];
            sweeps.turn(turn);
        }
        sweeps.read(out.data());
        Eigen::VectorXd d(48);
        for (int i = 0; i < 48; ++i) d[i] = out[static_cast<size_t>(i * W + W - 1)];
        return d;
    };
    OneSampleSweeps one(s.graph);
    SingleSweeps<8> eight(s.graph);
    DoubleSweeps<1> in_double(s.graph, std::make_unique<IncompleteCholesky<1>>(s.graph));
    const Eigen::VectorXd expected = first_steps(static_cast<LinearSweeps<1>&>(in_double));
    // Single precision, times the Hessian's condition number.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(s.hessian(0.0));
    const double condition = eigen.eigenvalues()[47] / eigen.eigenvalues()[0];
    EXPECT_LT((first_steps(static_cast<LinearSweeps<1>&>(one)) - expected).norm(), 6e-7 * condition * expected.norm());
    // Eight lanes keep eight bits of the factor.
    EXPECT_LT((first_steps(static_cast<LinearSweeps<8>&>(eight)) - expected).norm(), 0.05 * expected.norm());
}

TEST(SpringGraph, IncompleteFactorOfAPathIsComplete) {
    // No fill, nothing left out: the factor is exact but for single precision.
    QuasistaticModel model;
    model.vertex_count = 16;
    model.edge_spring.resize(15, 2);
    for (int e = 0; e < 15; ++e) model.edge_spring.row(e) << e, e + 1;
    model.edge_stiffness = Eigen::VectorXd::Constant(15, 300.0);
    model.edge_rest_length = Eigen::VectorXd::Constant(15, 0.02);
    model.bending_spring.resize(0, 2);
    model.axial_spring.resize(0, 4);
    model.axial_weight.resize(0, 2);
    model.target_stiffness = model.target_unit = Eigen::VectorXd::Constant(16, 20.0);
    Springs s(0.004);
    s.model = model;
    s.graph = SpringGraph(model);
    const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(48, -1.0, 2.0);
    IncompleteCholesky<1> incomplete(s.graph);
    EXPECT_LT((apply<1>(incomplete, s, 0.0, s.hessian(0.0) * expected) - expected).norm(), 1e-4 * expected.norm());
}

}  // namespace
}  // namespace toile::prior::test

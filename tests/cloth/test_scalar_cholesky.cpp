#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstring>
#include <limits>
#include <thread>

#include "cloth/error.h"
#include "cloth/scalar_cholesky.h"
#include "tests/cloth/vertex_graphs.h"
#include "tests/support/allocation_counter.h"

namespace toile {
namespace {

std::shared_ptr<const BlockSymbolic> analyse(const VertexGraph& graph) {
    return std::make_shared<const BlockSymbolic>(graph.vertex_count, graph.pairs);
}

/// A random positive definite matrix, `[slot]`: more than diagonally dominant.
std::vector<double> random_values(const BlockSymbolic& symbolic) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    std::vector<double> value(symbolic.slot_count(), 0.01);
    for (int k = 0; k < static_cast<int>(symbolic.pair().size()); ++k) {
        const double x = value[symbolic.vertex_count() + k] = number(random);
        value[symbolic.pair()[k].first] += std::abs(x);
        value[symbolic.pair()[k].second] += std::abs(x);
    }
    return value;
}

Eigen::MatrixXd dense_scalar_matrix(const BlockSymbolic& symbolic, const std::vector<double>& value) {
    const int v = symbolic.vertex_count();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(v, v);
    for (int k = 0; k < v; ++k) dense(k, k) = value[k];
    for (int k = 0; k < static_cast<int>(symbolic.pair().size()); ++k) {
        const auto [i, j] = symbolic.pair()[k];
        dense(i, j) = dense(j, i) = value[v + k];
    }
    return dense;
}

class ScalarCholeskyGraph : public testing::TestWithParam<VertexGraph> {};

TEST_P(ScalarCholeskyGraph, SolvesForEightSamplesAndOne) {
    const auto symbolic = analyse(GetParam());
    const int v = symbolic->vertex_count();
    const std::vector<double> value = random_values(*symbolic);
    const ScalarCholesky cholesky(symbolic, value);
    const LaneArray right = random_array(24 * static_cast<size_t>(v), 3);
    LaneArray eight = random_array(24 * static_cast<size_t>(v), 3);
    cholesky.solve<8>(eight.data());
    const Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>> b(right.data(), v, 24),
        x(eight.data(), v, 24);
    const Eigen::MatrixXd expected = dense_scalar_matrix(*symbolic, value).llt().solve(b);
    EXPECT_LT((x - expected).norm(), 1e-11 * expected.norm());
    for (int lane = 0; lane < 8; ++lane) {
        std::vector<double> one(3 * static_cast<size_t>(v));
        for (size_t k = 0; k < one.size(); ++k) one[k] = right[8 * k + lane];
        cholesky.solve<1>(one.data());
        for (size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], eight[8 * k + lane], 1e-11 * expected.norm());
    }
}

TEST_P(ScalarCholeskyGraph, ALaneDependsOnThatLaneAlone) {
    const auto symbolic = analyse(GetParam());
    const size_t n = 3 * static_cast<size_t>(symbolic->vertex_count());
    const ScalarCholesky cholesky(symbolic, random_values(*symbolic));
    LaneArray x = random_array(8 * n, 3), y = random_array(8 * n, 4);
    for (size_t k = 0; k < n; ++k) {
        y[8 * k + 1] = x[8 * k + 6];
        y[8 * k + 6] = std::numeric_limits<double>::quiet_NaN();
    }
    cholesky.solve<8>(x.data());
    cholesky.solve<8>(y.data());
    for (size_t k = 0; k < n; ++k) ASSERT_EQ(std::memcmp(&x[8 * k + 6], &y[8 * k + 1], sizeof(double)), 0) << k;
}

TEST_P(ScalarCholeskyGraph, SolvingDoesNotAllocate) {
    const auto symbolic = analyse(GetParam());
    const ScalarCholesky cholesky(symbolic, random_values(*symbolic));
    LaneArray x = random_array(24 * static_cast<size_t>(symbolic->vertex_count()), 3);
    const long before = allocation_count();
    cholesky.solve<1>(x.data());
    cholesky.solve<8>(x.data());
    EXPECT_EQ(allocation_count(), before);
}

INSTANTIATE_TEST_SUITE_P(Graphs, ScalarCholeskyGraph, testing::ValuesIn(vertex_graphs()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

TEST(ScalarCholesky, RefusesWhatItCannotFactor) {
    const auto symbolic = analyse(grid_graph("", 4, 4, false));
    const std::vector<double> good = random_values(*symbolic);
    EXPECT_NO_THROW(ScalarCholesky(symbolic, good));
    auto value = good;
    value[7] = -value[7];
    EXPECT_THROW(ScalarCholesky(symbolic, value), Error);
    value = good;
    value[20] = 100.0;
    EXPECT_THROW(ScalarCholesky(symbolic, value), Error);
    value = good;
    value[20] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ScalarCholesky(symbolic, value), Error);
    value = good;
    value[3] = std::numeric_limits<double>::infinity();
    EXPECT_THROW(ScalarCholesky(symbolic, value), Error);
    value = good;
    value.pop_back();
    EXPECT_THROW(ScalarCholesky(symbolic, value), Error);
}

TEST(ScalarCholesky, ThreadsShareOneFactor) {
    const auto symbolic = analyse(grid_graph("", 13, 17, false));
    const size_t size = 24 * static_cast<size_t>(symbolic->vertex_count());
    const ScalarCholesky cholesky(symbolic, random_values(*symbolic));
    LaneArray x = random_array(size, 3), y = random_array(size, 3);
    std::thread first([&] { cholesky.solve<8>(x.data()); }), second([&] { cholesky.solve<8>(y.data()); });
    first.join();
    second.join();
    EXPECT_EQ(std::memcmp(x.data(), y.data(), size * sizeof(double)), 0);
}

}  // namespace
}  // namespace toile

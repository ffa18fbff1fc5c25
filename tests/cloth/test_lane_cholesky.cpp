#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstring>
#include <limits>
#include <thread>

#include "cloth/lane_cholesky.h"
#include "tests/cloth/vertex_graphs.h"
#include "tests/support/allocation_counter.h"

namespace toile {
namespace {

std::shared_ptr<const BlockSymbolic> analyse(const VertexGraph& graph) {
    return std::make_shared<const BlockSymbolic>(graph.vertex_count, graph.pairs);
}

/// Eight matrices side by side, `[slot][9][8]`, each scaled by another power of ten.
LaneArray eight_matrices(const BlockSymbolic& symbolic, std::vector<std::vector<double>>& single) {
    LaneArray blocks(72 * static_cast<size_t>(symbolic.slot_count()));
    for (unsigned lane = 0; lane < 8; ++lane) {
        single.push_back(positive_definite_blocks(symbolic, lane));
        for (double& x : single.back()) x *= std::pow(10.0, static_cast<int>(lane) - 4);
        for (size_t k = 0; k < single.back().size(); ++k) blocks[8 * k + lane] = single.back()[k];
    }
    return blocks;
}

double relative_error(const Eigen::VectorXd& x, const Eigen::VectorXd& expected) {
    return (x - expected).norm() / expected.norm();
}

/// Cholesky's backward error is some units in the last place of each number; here the condition is below 1e4.
constexpr double tolerance = 1e-11;

class LaneCholeskyGraph : public testing::TestWithParam<VertexGraph> {};

TEST_P(LaneCholeskyGraph, EightLanesSolveEightMatrices) {
    const auto symbolic = analyse(GetParam());
    const int n = 3 * symbolic->vertex_count();
    std::vector<std::vector<double>> single;
    const LaneArray blocks = eight_matrices(*symbolic, single);
    LaneCholesky<8> cholesky(symbolic);
    ASSERT_TRUE(cholesky.factor(blocks.data()).all());
    const LaneArray right = random_array(8 * static_cast<size_t>(n), 3);
    LaneArray x = random_array(8 * static_cast<size_t>(n), 3);
    cholesky.solve(x.data());
    for (int lane = 0; lane < 8; ++lane) {
        const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<8>> b(right.data() + lane, n),
            y(x.data() + lane, n);
        const Eigen::VectorXd expected = dense_matrix(*symbolic, single[lane]).llt().solve(Eigen::VectorXd(b));
        EXPECT_LT(relative_error(y, expected), tolerance) << "lane " << lane;
    }
}

TEST_P(LaneCholeskyGraph, OneLaneSolvesOneMatrix) {
    const auto symbolic = analyse(GetParam());
    const int n = 3 * symbolic->vertex_count();
    const std::vector<double> blocks = positive_definite_blocks(*symbolic, 1);
    LaneCholesky<1> cholesky(symbolic);
    ASSERT_TRUE(cholesky.factor(blocks.data()).all());
    const LaneArray right = random_array(n, 3);
    LaneArray x = random_array(n, 3);
    cholesky.solve(x.data());
    const Eigen::Map<const Eigen::VectorXd> b(right.data(), n), y(x.data(), n);
    EXPECT_LT(relative_error(y, dense_matrix(*symbolic, blocks).llt().solve(b)), tolerance);
}

TEST_P(LaneCholeskyGraph, ManyRightHandSidesAreSolvedAsOneByOne) {
    const auto symbolic = analyse(GetParam());
    const int n = 3 * symbolic->vertex_count();
    const std::vector<double> blocks = positive_definite_blocks(*symbolic, 1);
    LaneCholesky<1> cholesky(symbolic);
    ASSERT_TRUE(cholesky.factor(blocks.data()).all());
    for (const int count : {1, 7, 8, 11}) {
        const LaneArray right = random_array(static_cast<size_t>(n * count), 3);
        LaneArray many = random_array(static_cast<size_t>(n * count), 3);
        cholesky.solve_many(many.data(), count);
        for (int side = 0; side < count; ++side) {
            Eigen::VectorXd x(n), y(n);
            for (int k = 0; k < n; ++k) x[k] = right[k * count + side], y[k] = many[k * count + side];
            cholesky.solve(x.data());
            EXPECT_LT(relative_error(y, x), tolerance) << "side " << side << " of " << count;
        }
    }
}

TEST_P(LaneCholeskyGraph, FactorsAndSolvesInOne) {
    const auto symbolic = analyse(GetParam());
    const size_t n = 3 * static_cast<size_t>(symbolic->vertex_count());
    std::vector<std::vector<double>> single;
    LaneArray blocks = eight_matrices(*symbolic, single);
    blocks[4] = -1.0;  // lane 4 is not positive definite
    LaneArray x = random_array(8 * n, 3), y = random_array(8 * n, 3);
    LaneCholesky<8> cholesky(symbolic);
    const std::bitset<8> good = cholesky.factor(blocks.data());
    cholesky.solve(x.data());
    EXPECT_EQ(good, std::bitset<8>("11101111"));
    EXPECT_EQ(LaneCholesky<8>(symbolic).factor_and_solve(blocks.data(), y.data()), good);
    EXPECT_EQ(std::memcmp(x.data(), y.data(), 8 * n * sizeof(double)), 0);
}

TEST_P(LaneCholeskyGraph, ALaneDependsOnThatLaneAlone) {
    const auto symbolic = analyse(GetParam());
    const size_t n = 3 * static_cast<size_t>(symbolic->vertex_count());
    std::vector<std::vector<double>> single;
    LaneArray blocks = eight_matrices(*symbolic, single);
    LaneArray x = random_array(8 * n, 3);
    LaneCholesky<8> cholesky(symbolic);
    ASSERT_TRUE(cholesky.factor(blocks.data()).all());
    cholesky.solve(x.data());
    // Lane 5 again, now as lane 2 among matrices that are indefinite, zero, infinite or NaN.
    const double spoilt[8] = {-1.0,
                              0.0,
                              0.0,
                              1e300,
                              std::numeric_limits<double>::infinity(),
                              1e-300,
                              -0.0,
                              std::numeric_limits<double>::quiet_NaN()};
    LaneArray other = random_array(8 * n, 3);
    for (size_t k = 0; k < n; ++k) other[8 * k + 2] = other[8 * k + 5];
    for (size_t k = 0; k < blocks.size(); k += 8)
        for (int lane = 0; lane < 8; ++lane) blocks[k + lane] = lane == 2 ? single[5][k / 8] : spoilt[lane];
    EXPECT_TRUE(cholesky.factor(blocks.data())[2]);
    cholesky.solve(other.data());
    for (size_t k = 0; k < n; ++k) ASSERT_EQ(std::memcmp(&x[8 * k + 5], &other[8 * k + 2], sizeof(double)), 0) << k;
}

TEST_P(LaneCholeskyGraph, TellsWhichLanesAreNotPositiveDefinite) {
    const auto symbolic = analyse(GetParam());
    const int vertex_count = symbolic->vertex_count();
    std::vector<std::vector<double>> single;
    LaneArray blocks = eight_matrices(*symbolic, single);
    const auto last = 9 * static_cast<size_t>(vertex_count - 1);
    const auto set = [&](size_t number, int lane, double value) {
        single[lane][number] = value;
        blocks[8 * number + lane] = value;
    };
    set(last + 8, 1, -1e-3);                                    // a negative diagonal, in the last vertex
    set(0, 3, 0.0);                                             // a zero one, in the first
    set(4, 4, std::numeric_limits<double>::quiet_NaN());        // NaN
    set(last + 4, 6, std::numeric_limits<double>::infinity());  // infinity
    set(3, 7, 1e9);                                             // indefinite by what is off the diagonal
    LaneCholesky<8> eight(symbolic);
    EXPECT_EQ(eight.factor(blocks.data()), std::bitset<8>("00100101"));
    LaneCholesky<1> one(symbolic);
    for (int lane = 0; lane < 8; ++lane)
        EXPECT_EQ(one.factor(single[lane].data()).all(), lane == 0 || lane == 2 || lane == 5) << "lane " << lane;
    EXPECT_TRUE(one.factor(single[0].data()).all());
}

TEST_P(LaneCholeskyGraph, ReadsTheLowerTriangleOfDiagonalBlocks) {
    const auto symbolic = analyse(GetParam());
    const int n = 3 * symbolic->vertex_count();
    std::vector<double> blocks = positive_definite_blocks(*symbolic, 1);
    LaneCholesky<1> cholesky(symbolic);
    LaneArray x = random_array(n, 3), y = random_array(n, 3);
    cholesky.factor(blocks.data());
    cholesky.solve(x.data());
    for (int v = 0; v < symbolic->vertex_count(); ++v)
        for (const int upper : {1, 2, 5}) blocks[9 * static_cast<size_t>(v) + upper] = 1e6;
    ASSERT_TRUE(cholesky.factor(blocks.data()).all());
    cholesky.solve(y.data());
    for (int k = 0; k < n; ++k) EXPECT_EQ(x[k], y[k]);
}

TEST_P(LaneCholeskyGraph, DoesNotAllocate) {
    const auto symbolic = analyse(GetParam());
    const size_t n = 3 * static_cast<size_t>(symbolic->vertex_count());
    std::vector<std::vector<double>> single;
    const LaneArray blocks = eight_matrices(*symbolic, single);
    LaneCholesky<8> eight(symbolic);
    LaneCholesky<1> one(symbolic);
    LaneArray x = random_array(11 * n, 3);
    const long before = allocation_count();
    eight.factor(blocks.data());
    eight.solve(x.data());
    one.factor(single[0].data());
    one.solve(x.data());
    one.solve_many(x.data(), 11);
    eight.factor_and_solve(blocks.data(), x.data());
    EXPECT_EQ(allocation_count(), before);
    EXPECT_GT(std::make_unique<LaneArray>(1)->size() + allocation_count(), before + 1);  // it does count
}

INSTANTIATE_TEST_SUITE_P(Graphs, LaneCholeskyGraph, testing::ValuesIn(vertex_graphs()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

TEST(LaneCholesky, ThreadsShareTheSymbolicPart) {
    const auto symbolic = analyse(grid_graph("", 13, 17, false));
    const size_t n = 3 * static_cast<size_t>(symbolic->vertex_count());
    std::vector<std::vector<double>> single;
    const LaneArray blocks = eight_matrices(*symbolic, single);
    LaneArray x[3] = {random_array(8 * n, 3), random_array(8 * n, 3), random_array(8 * n, 3)};
    const auto run = [&](int k) {
        LaneCholesky<8> cholesky(symbolic);
        cholesky.factor(blocks.data());
        cholesky.solve(x[k].data());
    };
    std::thread first(run, 0), second(run, 1);
    first.join();
    second.join();
    run(2);
    EXPECT_EQ(std::memcmp(x[0].data(), x[2].data(), 8 * n * sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(x[1].data(), x[2].data(), 8 * n * sizeof(double)), 0);
}

TEST(LaneCholesky, TakesNoVertices) {
    LaneCholesky<8> cholesky(std::make_shared<const BlockSymbolic>(0, std::vector<std::pair<int, int>>{}));
    EXPECT_TRUE(cholesky.factor(nullptr).all());
    cholesky.solve(nullptr);
}

}  // namespace
}  // namespace toile

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "prior/cone_kkt.h"
#include "tests/prior/inextensible_cases.h"

namespace toile::prior::test {
namespace {

struct DenseSystem {
    Eigen::MatrixXd matrix;

    DenseSystem(const InextensibleCase& cloth, ConeKkt& kkt, double compliance) {
        const Eigen::Index v = 3 * cloth.model.vertex_count, edges = cloth.model.edge.rows();
        matrix = Eigen::MatrixXd::Zero(v + edges, v + edges);
        for (Eigen::Index i = 0; i < v; ++i) matrix(i, i) = cloth.model.target_stiffness[i / 3];
        kkt.begin(cloth.model.target_stiffness);
        for (Eigen::Index e = 0; e < edges; ++e) {
            const Eigen::Index a = 3 * cloth.model.edge(e, 0), b = 3 * cloth.model.edge(e, 1);
            const Eigen::Vector3d g(0.5, 0.1 * static_cast<double>(e), -0.3);
            const double transverse = 0.2 + 0.01 * static_cast<double>(e);
            kkt.set_edge(e, transverse, g, compliance);
            matrix.block<3, 3>(a, a).diagonal().array() += transverse;
            matrix.block<3, 3>(b, b).diagonal().array() += transverse;
            matrix.block<3, 3>(a, b).diagonal().array() -= transverse;
            matrix.block<3, 3>(b, a).diagonal().array() -= transverse;
            matrix.block<1, 3>(v + e, a) = g.transpose();
            matrix.block<1, 3>(v + e, b) = -g.transpose();
            matrix.block<3, 1>(a, v + e) = g;
            matrix.block<3, 1>(b, v + e) = -g;
            matrix(v + e, v + e) = -compliance;
        }
    }
};

TEST(ConeKkt, SolvesTheSystemItDescribes) {
    InextensibleCase cloth = patch(4, 3);
    cloth.model.target_stiffness[2] = 30.0;
    ConeKkt kkt(cloth.model.edge, cloth.model.vertex_count);
    for (double compliance : {1.0, 1e-3, 1e-9}) {  // one analysis, several matrices
        const DenseSystem dense(cloth, kkt, compliance);
        ASSERT_TRUE(kkt.factor());
        const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(kkt.size(), -1.0, 3.0);
        Eigen::VectorXd solution;
        const double error = kkt.solve(dense.matrix * expected, solution);
        EXPECT_LT(error, 1e-13);
        EXPECT_LT((dense.matrix * (solution - expected)).norm(), 1e-12 * expected.norm());
    }
}

TEST(ConeKkt, TakesEdgesInEitherDirectionAndMoreThanOnce) {
    InextensibleCase cloth = patch(2, 2);
    cloth.model.edge.conservativeResize(7, 2);
    cloth.model.edge.bottomRows<2>() << 1, 0, 0, 1;
    ConeKkt kkt(cloth.model.edge, cloth.model.vertex_count);
    const DenseSystem dense(cloth, kkt, 0.1);
    ASSERT_TRUE(kkt.factor());
    const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(kkt.size(), 1.0, 2.0);
    Eigen::VectorXd solution;
    kkt.solve(dense.matrix * expected, solution);
    EXPECT_LT((solution - expected).norm(), 1e-10);
}

TEST(ConeKkt, GivesZeroForZero) {
    const InextensibleCase cloth = patch(2, 2);
    ConeKkt kkt(cloth.model.edge, cloth.model.vertex_count);
    const DenseSystem dense(cloth, kkt, 0.1);
    ASSERT_TRUE(kkt.factor());
    Eigen::VectorXd solution;
    EXPECT_EQ(kkt.solve(Eigen::VectorXd::Zero(kkt.size()), solution), 0.0);
    EXPECT_EQ(solution.norm(), 0.0);
}

}  // namespace
}  // namespace toile::prior::test

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cloth/error.h"
#include "simulate/contact_candidates.h"
#include "tests/simulate/cloth_square.h"
#include "tests/simulate/random_points.h"

namespace toile::simulate {
namespace {

struct Scene {
    Triangles triangle;
    Edges edge;
    Positions x;

    Scene(const Triangles& t, const Positions& position) : triangle(t), edge(build_topology(t).edge), x(position) {}
};

bool share_a_vertex(const std::array<int, 4>& point, int first_count) {
    for (int i = 0; i < first_count; ++i)
        for (int j = first_count; j < 4; ++j)
            if (point[i] == point[j]) return true;
    return false;
}

// All pairs of features, those that share a vertex apart, that `keep` accepts.
template <typename Keep>
CandidatePairs brute_force(const Scene& scene, const Keep& keep) {
    CandidatePairs pairs;
    for (int v = 0; v < scene.x.rows(); ++v) {
        for (int f = 0; f < scene.triangle.rows(); ++f) {
            const std::array<int, 4> p = {v, scene.triangle(f, 0), scene.triangle(f, 1), scene.triangle(f, 2)};
            if (!share_a_vertex(p, 1) && keep(p, 1)) pairs.vertex_triangle.push_back({v, f, p});
        }
    }
    for (int a = 0; a < scene.edge.rows(); ++a) {
        for (int b = a + 1; b < scene.edge.rows(); ++b) {
            const std::array<int, 4> p = {scene.edge(a, 0), scene.edge(a, 1), scene.edge(b, 0), scene.edge(b, 1)};
            if (!share_a_vertex(p, 2) && keep(p, 2)) pairs.edge_edge.push_back({a, b, p});
        }
    }
    return pairs;
}

double squared_distance(const FourPoints& x, int first_count) {
    return (first_count == 1 ? vertex_triangle_proximity(x) : edge_edge_proximity(x)).squared_distance;
}

CandidatePairs brute_force_near(const Scene& scene, double radius) {
    return brute_force(scene, [&](const std::array<int, 4>& p, int first_count) {
        return squared_distance(gather(scene.x, p), first_count) <= radius * radius;
    });
}

// Nearer than the radius at one of a few moments.
CandidatePairs brute_force_swept(const Scene& scene, const Positions& motion, double radius) {
    return brute_force(scene, [&](const std::array<int, 4>& p, int first_count) {
        for (int step = 0; step <= 8; ++step) {
            const Positions now = scene.x + step / 8.0 * motion;
            if (squared_distance(gather(now, p), first_count) <= radius * radius) return true;
        }
        return false;
    });
}

void expect_equal(const CandidatePairs& a, const CandidatePairs& b) {
    EXPECT_EQ(a.vertex_triangle, b.vertex_triangle);
    EXPECT_EQ(a.edge_edge, b.edge_edge);
}

template <typename Pair, typename Key>
bool all_within(const std::vector<Pair>& few, const std::vector<Pair>& many, const Key& key) {
    std::set<std::pair<int, int>> known;
    for (const Pair& pair : many) known.insert(key(pair));
    return std::all_of(few.begin(), few.end(), [&](const Pair& pair) { return known.count(key(pair)) == 1; });
}
void expect_within(const CandidatePairs& few, const CandidatePairs& many) {
    EXPECT_TRUE(all_within(few.vertex_triangle, many.vertex_triangle,
                           [](const VertexTrianglePair& p) { return std::pair(p.vertex, p.triangle); }));
    EXPECT_TRUE(
        all_within(few.edge_edge, many.edge_edge, [](const EdgeEdgePair& p) { return std::pair(p.first, p.second); }));
}

// A sheet folded to and fro, in a place and direction of its own.
Scene folded_sheet(int n, double layer, const Eigen::Vector3d& place) {
    const ClothMesh mesh = test::cloth_square(n, 0.3, 0.0);
    Positions x = mesh.rest_position;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    for (Eigen::Index v = 0; v < x.rows(); ++v) {
        const double along = x(v, 0) + 0.15, flat = 0.1;
        const int fold = static_cast<int>(along / flat);
        const double rest = along - fold * flat;
        const Eigen::Vector3d point(fold % 2 == 0 ? rest : flat - rest, layer * along / flat, x(v, 2));
        x.row(v) = (turn * point + place).transpose();
    }
    return {mesh.triangle, x};
}

// Triangles anywhere, some of them joined, of sizes from 1 to 30 and some thin as needles.
Scene soup(unsigned seed, int count, double size) {
    test::RandomPoints random(seed);
    Triangles triangle(count, 3);
    Positions x(3 * count, 3);
    for (int f = 0; f < count; ++f) {
        const Eigen::Vector3d middle = random.point(size);
        const double reach = size * (f % 10 == 0 ? 0.6 : 0.02);
        for (int k = 0; k < 3; ++k) {
            triangle(f, k) = f > 0 && k == 0 && f % 3 == 0 ? triangle(f - 1, 1) : 3 * f + k;
            x.row(3 * f + k) = (middle + random.point(reach)).transpose();
        }
        if (f % 7 == 0) x.row(3 * f + 2) = 0.999 * x.row(3 * f + 1) + 0.001 * x.row(3 * f + 2);
    }
    return {triangle, x};
}

void expect_like_brute_force(const Scene& scene, double radius) {
    ContactCandidates candidates(scene.triangle, scene.edge);
    CandidatePairs found;
    candidates.find(scene.x, radius, found);
    const CandidatePairs expected = brute_force_near(scene, radius);
    EXPECT_FALSE(expected.edge_edge.empty());
    expect_equal(found, expected);
}

TEST(ContactCandidates, OfAFoldedSheetAreThoseOfBruteForce) {
    for (const double radius : {2e-3, 4e-3, 0.02})
        expect_like_brute_force(folded_sheet(16, 2e-3, Eigen::Vector3d::Zero()), radius);
}

TEST(ContactCandidates, FarFromTheOriginNoneIsLost) {
    expect_like_brute_force(folded_sheet(16, 2e-3, {1000.0, -1000.0, 300.0}), 4e-3);
}

TEST(ContactCandidates, OfASoupOfAllSizesAreThoseOfBruteForce) {
    for (unsigned seed = 0; seed < 10; ++seed)
        for (const double size : {1e-3, 1.0}) expect_like_brute_force(soup(seed, 100, size), 0.02 * size);
}

TEST(ContactCandidates, TouchingFeaturesAreFoundWithoutARadius) {
    Triangles triangle(2, 3);
    triangle << 0, 1, 2, 3, 4, 5;
    Positions x(6, 3);
    x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0, 0.25, 0.25, 1, 2, 2, 0.5;
    ContactCandidates candidates(triangle, build_topology(triangle).edge);
    CandidatePairs found;
    candidates.find(x, 0.0, found);
    ASSERT_EQ(found.vertex_triangle.size(), 1u);
    EXPECT_EQ(found.vertex_triangle[0].vertex, 3);
    EXPECT_EQ(found.vertex_triangle[0].triangle, 0);
}

TEST(ContactCandidates, OneVertexAMetreAwayChangesOnlyItsOwnPairs) {
    Scene scene = folded_sheet(20, 2e-3, Eigen::Vector3d::Zero());
    scene.x.row(200) += Eigen::RowVector3d(0.6, 0.5, -0.6);
    expect_like_brute_force(scene, 4e-3);
}

TEST(ContactCandidates, NeedlesAreFound) {
    Scene scene = folded_sheet(12, 2e-3, Eigen::Vector3d::Zero());
    scene.x.col(2) *= 1e-3;
    expect_like_brute_force(scene, 1e-5);
}

TEST(ContactCandidates, OfAMotionAreAtLeastThoseThatMeet) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Scene scene = soup(seed, 60, 1.0);
        test::RandomPoints random(seed + 100);
        Positions motion(scene.x.rows(), 3);
        for (Eigen::Index v = 0; v < motion.rows(); ++v) motion.row(v) = random.point(0.1).transpose();
        motion.row(7) *= 10.0;
        motion.rowwise() += Eigen::RowVector3d(3.0, 0.0, -2.0);
        ContactCandidates candidates(scene.triangle, scene.edge);
        CandidatePairs swept, still;
        candidates.find(scene.x, motion, 0.01, swept);
        candidates.find(scene.x, 0.01, still);
        const CandidatePairs meeting = brute_force_swept(scene, motion, 0.01);
        EXPECT_GT(meeting.edge_edge.size(), still.edge_edge.size());
        expect_within(meeting, swept);
        expect_within(still, swept);
        for (const EdgeEdgePair& pair : swept.edge_edge) {
            const FourPoints moved = gather(motion, pair.point);
            const double relative = std::max({(moved[0] - moved[2]).norm(), (moved[0] - moved[3]).norm(),
                                              (moved[1] - moved[2]).norm(), (moved[1] - moved[3]).norm()});
            EXPECT_LE(edge_edge_proximity(gather(scene.x, pair.point)).distance(), 0.01 + relative + 1e-9);
        }
        EXPECT_TRUE(std::is_sorted(swept.edge_edge.begin(), swept.edge_edge.end(), [](auto& a, auto& b) {
            return std::pair(a.first, a.second) < std::pair(b.first, b.second);
        }));
    }
}

TEST(ContactCandidates, OfACommonMotionAreThoseOfRest) {
    const Scene scene = folded_sheet(16, 2e-3, Eigen::Vector3d::Zero());
    ContactCandidates candidates(scene.triangle, scene.edge);
    CandidatePairs moving, still;
    const Positions motion = Eigen::RowVector3d(0.5, -0.25, 0.125).replicate(scene.x.rows(), 1);
    candidates.find(scene.x, motion, 4e-3, moving);
    candidates.find(scene.x, 4e-3, still);
    EXPECT_FALSE(still.edge_edge.empty());
    expect_equal(moving, still);
}

// Every seventh feature reaches further.
Eigen::VectorXd uneven(Eigen::Index size, double reach) {
    return Eigen::VectorXd::NullaryExpr(size, [&](Eigen::Index i) { return i % 7 == 0 ? reach : 0.1 * reach; });
}

TEST(ContactCandidates, FeaturesReachAsFarAsTheLesserOfTheTwo) {
    const Scene scene = folded_sheet(16, 2e-3, Eigen::Vector3d::Zero());
    const double radius = 1e-3, reach = 8e-3;
    const Eigen::VectorXd vertex = uneven(scene.x.rows(), reach), triangle = uneven(scene.triangle.rows(), reach),
                          edge = uneven(scene.edge.rows(), reach);
    ContactCandidates candidates(scene.triangle, scene.edge);
    CandidatePairs found, expected;
    candidates.find(scene.x, radius + reach, expected);
    const size_t all = expected.edge_edge.size();
    const auto near = [&](const Proximity& nearest, double lesser) { return nearest.distance() <= radius + lesser; };
    std::erase_if(expected.vertex_triangle, [&](const VertexTrianglePair& p) {
        return !near(vertex_triangle_proximity(gather(scene.x, p.point)),
                     std::min(vertex[p.vertex], triangle[p.triangle]));
    });
    std::erase_if(expected.edge_edge, [&](const EdgeEdgePair& p) {
        return !near(edge_edge_proximity(gather(scene.x, p.point)), std::min(edge[p.first], edge[p.second]));
    });
    candidates.set_reach(vertex, triangle, edge);
    candidates.find(scene.x, radius, found);
    EXPECT_FALSE(expected.edge_edge.empty());
    EXPECT_LT(expected.edge_edge.size(), all);
    expect_equal(found, expected);
    candidates.find(scene.x, Positions::Zero(scene.x.rows(), 3), radius, found);
    expect_equal(found, expected);
}

TEST(ContactCandidates, AMotionThatMeetsTooMuchIsHalved) {
    const Scene scene = folded_sheet(16, 2e-3, Eigen::Vector3d::Zero());
    const Positions motion = test::crumpled(Positions::Zero(scene.x.rows(), 3), 3.0);
    const long most = 20 * scene.edge.rows();
    ContactCandidates candidates(scene.triangle, scene.edge);
    CandidatePairs bounded, same;
    const double share = candidates.find_bounded(scene.x, motion, 1e-3, most, bounded);
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0);
    EXPECT_LE(static_cast<long>(bounded.edge_edge.size()), most);
    candidates.find(scene.x, share * motion, 1e-3, same);
    expect_equal(bounded, same);
    candidates.find(scene.x, 2.0 * share * motion, 1e-3, same);
    EXPECT_GT(same.edge_edge.size(), bounded.edge_edge.size());
    EXPECT_EQ(candidates.find_bounded(scene.x, share * motion, 1e-3, most, same), 1.0);
    // Where it isn't the motion, all pairs are found all the same.
    EXPECT_LT(candidates.find_bounded(scene.x, 0.0 * motion, 0.01, 10, bounded), 1e-6);
    candidates.find(scene.x, 0.01, same);
    expect_equal(bounded, same);
}

TEST(ContactCandidates, EarlierSearchesLeaveNoTrace) {
    const Scene scene = folded_sheet(16, 2e-3, Eigen::Vector3d::Zero());
    ContactCandidates used(scene.triangle, scene.edge), fresh(scene.triangle, scene.edge);
    CandidatePairs after, expected;
    used.find(test::crumpled(scene.x, 0.3), 0.1, after);
    used.find(scene.x, 4e-3, after);
    fresh.find(scene.x, 4e-3, expected);
    expect_equal(after, expected);
}

TEST(ContactCandidates, VerticesThatAreNotFiniteHideNoOthers) {
    Scene scene = folded_sheet(16, 2e-3, Eigen::Vector3d::Zero());
    const CandidatePairs clean = brute_force_near(scene, 4e-3);
    ContactCandidates candidates(scene.triangle, scene.edge);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, 1e30}) {
        scene.x.row(100).setConstant(bad);
        CandidatePairs found, expected = clean;
        candidates.find(scene.x, 4e-3, found);
        const auto touches = [](const auto& pair) {
            return std::find(pair.point.begin(), pair.point.end(), 100) != pair.point.end();
        };
        std::erase_if(expected.vertex_triangle, touches);
        std::erase_if(expected.edge_edge, touches);
        expect_within(expected, found);
    }
}

TEST(ContactCandidates, AnEmptyMeshHasNone) {
    ContactCandidates candidates(Triangles(0, 3), Edges(0, 2));
    CandidatePairs found;
    candidates.find(Positions(0, 3), 1.0, found);
    EXPECT_TRUE(found.vertex_triangle.empty() && found.edge_edge.empty());
}

TEST(ContactCandidates, RefusesWhatItCannotSearch) {
    const Scene scene = folded_sheet(4, 2e-3, Eigen::Vector3d::Zero());
    ContactCandidates candidates(scene.triangle, scene.edge);
    CandidatePairs found;
    EXPECT_NO_THROW(candidates.find(scene.x, 1e-3, found));
    EXPECT_THROW(candidates.find(scene.x.topRows(5), 1e-3, found), Error);
    EXPECT_THROW(candidates.find(scene.x, scene.x.topRows(5), 1e-3, found), Error);
    EXPECT_THROW(candidates.find(scene.x, -1e-3, found), Error);
    EXPECT_THROW(candidates.find(scene.x, std::nan(""), found), Error);
    const Eigen::VectorXd vertex = uneven(scene.x.rows(), 1.0), triangle = uneven(scene.triangle.rows(), 1.0),
                          edges = uneven(scene.edge.rows(), 1.0);
    EXPECT_NO_THROW(candidates.set_reach(vertex, triangle, edges));
    EXPECT_THROW(candidates.set_reach(triangle, triangle, edges), Error);
    EXPECT_THROW(candidates.set_reach(-vertex, triangle, edges), Error);
    Edges edge = scene.edge;
    edge(0, 1) = 1000;
    EXPECT_THROW(ContactCandidates(scene.triangle, edge), Error);
}

}  // namespace
}  // namespace toile::simulate

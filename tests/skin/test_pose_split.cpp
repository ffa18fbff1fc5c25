#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "cloth/error.h"
#include "skin/pose_sampler.h"
#include "skin/pose_split.h"
#include "tests/skin/stick_body.h"

namespace toile::skin {
namespace {

SplitOptions shares(double validation, double test, std::uint64_t seed = 0) {
    SplitOptions options;
    options.seed = seed;
    options.validation_share = validation;
    options.test_share = test;
    return options;
}

std::vector<Split> first_groups(const SplitOptions& options, int count) {
    SplitSequence sequence(options);
    std::vector<Split> split;
    for (int g = 0; g < count; ++g) split.push_back(sequence(g));
    return split;
}

double share_of(const std::vector<Split>& split, Split one) {
    return static_cast<double>(std::count(split.begin(), split.end(), one)) / static_cast<double>(split.size());
}

TEST(PoseSplit, EveryTenGroupsHaveOneToValidateAndOneToTest) {
    std::set<std::vector<Split>> different;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const std::vector<Split> split = first_groups(shares(0.1, 0.1, seed), 200);
        EXPECT_EQ(split.front(), Split::train);
        for (auto block = split.begin(); block != split.end(); block += 10) {
            EXPECT_EQ(std::count(block, block + 10, Split::validation), 1);
            EXPECT_EQ(std::count(block, block + 10, Split::test), 1);
        }
        different.insert(split);
    }
    EXPECT_EQ(different.size(), 50u);
}

TEST(PoseSplit, WholeBlocksHaveAllSplitsAndManyMeetTheShares) {
    for (const auto& [validation, test] : std::vector<std::pair<double, double>>{
             {0.15, 0.15}, {0.05, 0.1}, {0.33, 0.33}, {0.45, 0.45}, {0.07, 0.9}, {0.013, 0.02}}) {
        const SplitOptions options = shares(validation, test, 5);
        const int block = SplitSequence(options).block_size();
        EXPECT_EQ(block, std::ceil(1 / std::min({validation, test, 1 - validation - test}) - 1e-9));
        const std::vector<Split> split = first_groups(options, 40 * block);
        for (auto first = split.begin(); first != split.end(); first += block)
            EXPECT_EQ(std::set<Split>(first, first + block).size(), 3u) << validation << " " << test;
        for (std::size_t count = block; count <= split.size(); count += 7) {
            const std::vector<Split> head(split.begin(), split.begin() + count);
            EXPECT_NEAR(share_of(head, Split::validation), validation, (block + 0.0) / count);
            EXPECT_NEAR(share_of(head, Split::test), test, (block + 0.0) / count);
        }
    }
}

TEST(PoseSplit, AGroupKeepsItsSplitInWhateverOrderGroupsAreAsked) {
    const SplitOptions options = shares(0.1, 0.2, 3);
    const std::vector<Split> split = first_groups(options, 100);
    SplitSequence sequence(options);
    for (int g = 99; g >= 0; g -= 7) EXPECT_EQ(sequence(g), split[g]);
    for (int g = 0; g < 100; g += 13) EXPECT_EQ(sequence(g), split[g]);
}

TEST(PoseSplit, SharesOfNothingAndOfEverything) {
    EXPECT_EQ(share_of(first_groups(shares(0, 0), 50), Split::train), 1);
    EXPECT_EQ(share_of(first_groups(shares(0, 1), 50), Split::test), 1);
    EXPECT_EQ(share_of(first_groups(shares(1, 0), 50), Split::validation), 1);
    const std::vector<Split> half = first_groups(shares(0.5, 0.5), 50);
    EXPECT_EQ(share_of(half, Split::train), 0);
    EXPECT_EQ(share_of(half, Split::test), 0.5);
    // A share too small for a block is met by many blocks.
    EXPECT_NEAR(share_of(first_groups(shares(1e-4, 0.1), 400000), Split::validation), 1e-4, 2e-5);
}

/// The samples of one split are spread over the poses like the poses themselves: the shuffle does not keep step with
/// the sampler's sequence. Boxes of pairs of angles hold what as many random poses would leave in them.
TEST(PoseSplit, DoesNotResonateWithTheSampler) {
    const PoseSampler sampler(testing_support::stick_body(), {});
    const int count = 20000, side = 8;
    std::vector<std::vector<double>> angle;  // of each axis that varies, scaled to [0, 1)
    for (const auto& [role, unused] : sampler.angles(0).angle)
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> value;
            for (int k = 0; k < count; ++k) value.push_back(sampler.angles(k).angle.at(role)[axis]);
            const auto [low, high] = std::minmax_element(value.begin(), value.end());
            const double least = *low, range = *high - *low;
            if (range == 0) continue;
            for (double& v : value) v = std::min((v - least) / range, 1 - 1e-12);
            angle.push_back(value);
        }
    ASSERT_GT(angle.size(), 5u);
    const std::vector<Split> split = first_groups(shares(0.1, 0.1), count);
    const double expected = 0.1 * count / (side * side);
    for (std::size_t a = 0; a < angle.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            std::vector<int> box(side * side, 0);
            for (int k = 0; k < count; ++k)
                if (split[k] == Split::test)
                    ++box[static_cast<int>(side * angle[a][k]) * side + static_cast<int>(side * angle[b][k])];
            double chi_squared = 0;
            for (const int n : box) chi_squared += (n - expected) * (n - expected) / expected;
            // 63 degrees of freedom: random samples stay below 125 but for one pair in 100,000.
            EXPECT_LT(chi_squared, 125) << a << " " << b;
        }
}

TEST(PoseSplit, RemarksSayWhatIsAmiss) {
    PoseSplits splits;
    splits.groups = 12;
    splits.size = {10, 1, 1};
    EXPECT_TRUE(split_remarks(splits, {}).empty());
    splits.groups = splits.largest = 1;
    splits.size = {12, 0, 0};
    ASSERT_EQ(split_remarks(splits, {}).size(), 1u);
    EXPECT_NE(split_remarks(splits, {})[0].find("no sample is for validation and test: the poses make 1 group "),
              std::string::npos);
    EXPECT_TRUE(split_remarks(splits, shares(0, 0)).empty());
    splits.size = {10, 1, 1};
    splits.conflicts = 3;
    splits.first = 7;
    ASSERT_EQ(split_remarks(splits, {}).size(), 1u);
    EXPECT_EQ(split_remarks(splits, {})[0].find("3 poses, the first number 7, "), 0u);
}

TEST(PoseSplit, RefusesOneDefectAtATime) {
    SplitOptions options;
    EXPECT_NO_THROW(SplitSequence{options});
    options.test_share = 0.95;
    EXPECT_THROW(SplitSequence{options}, Error);
    options.test_share = -0.1;
    EXPECT_THROW(SplitSequence{options}, Error);
    options.test_share = std::nan("");
    EXPECT_THROW(SplitSequence{options}, Error);
    options = {};
    options.duplicate_angle = 4;
    EXPECT_THROW(SplitSequence{options}, Error);
}

}  // namespace
}  // namespace toile::skin

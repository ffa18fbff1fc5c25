#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cloth/error.h"
#include "files/sample_bytes.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::files {
namespace {

SampleRecord detailed_sample() {
    SampleRecord sample = test::sample_of(test::header_of(true, true), 3);
    sample.certificate.detail = CertificateDetail{0.5, 2, 30, 4, 2, 1, {0, 1, -1, -1}, {1e-4, 2e-4, -1, -1}};
    return sample;
}

TEST(SampleBytes, AreTheSampleAgain) {
    const SampleRecord sample = detailed_sample();
    const SampleRecord again = sample_from_bytes(sample_bytes(sample));
    test::expect_same(sample, again);
    EXPECT_EQ(again.certificate.seconds, sample.certificate.seconds);
    EXPECT_EQ(again.resampling_error, sample.resampling_error);
    EXPECT_EQ(again.certificate.detail->rung_residual_force, sample.certificate.detail->rung_residual_force);
    EXPECT_EQ(sample_digest(again), sample_digest(sample));
}

TEST(SampleBytes, KeepTheDigestOfWhatIsRoundedWhenStored) {
    SampleRecord sample = detailed_sample();
    sample.cloth(1, 2) = 0.1;  // not a number in single precision
    sample.frame[0] = Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4);
    sample.pose(0, 0) = 0.1;
    const SampleRecord again = sample_from_bytes(sample_bytes(sample));
    EXPECT_EQ(sample_digest(again), sample_digest(sample));
    EXPECT_EQ(again.pose(0, 0), 0.1);
}

TEST(SampleBytes, HoldWhatIsNotFiniteAndWhatIsMissing) {
    SampleRecord sample = test::sample_of(test::header_of(false, false), 0);
    sample.cloth.setConstant(std::numeric_limits<double>::quiet_NaN());
    const SampleRecord again = sample_from_bytes(sample_bytes(sample));
    EXPECT_EQ(again.cloth.rows(), sample.cloth.rows());
    EXPECT_FALSE(again.cloth.allFinite());
    EXPECT_EQ(again.pose.rows(), 0);
    EXPECT_FALSE(again.certificate.detail);
    EXPECT_EQ(sample_digest(again), sample_digest(sample));
}

TEST(SampleBytes, AreRefusedWhereTheyEndTooSoon) {
    const std::string bytes = sample_bytes(detailed_sample());
    for (size_t size = 0; size < bytes.size(); ++size)
        EXPECT_THROW(sample_from_bytes(std::string_view(bytes).substr(0, size)), Error) << size;
    EXPECT_THROW(sample_from_bytes(bytes + '\0'), Error);
}

TEST(SampleBytes, AreRefusedWhereAListIsLongerThanTheyAre) {
    const std::string bytes = sample_bytes(detailed_sample());
    for (size_t at = 0; at + 8 <= bytes.size(); ++at) {
        std::string damaged = bytes;
        damaged.replace(at, 8, std::string("\0\0\0\0\0\1\0\0", 8));  // 2^40, where it falls on a length
        try {
            sample_from_bytes(damaged);
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("cannot be read")) << at;
        }
    }
}

}  // namespace
}  // namespace toile::files

#include <gmock/gmock.h>

#include "cloth/error.h"
#include "evaluate/image_predictor.h"
#include "tests/evaluate/predictor_dataset.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

class ImageRoute : public PredictorTest {
  protected:
    std::string refusal(const std::string& dataset) const {
        try {
            const files::DatasetReader reader(dataset);
            const PredictorData data(reader);
            make_image_predictor(data);
            return "";
        } catch (const Error& error) {
            EXPECT_THAT(error.where(), HasSubstr("/image"));
            return error.what();
        }
    }
};

TEST_F(ImageRoute, ReadsTheDisplacementBackWithinTheStatedError) {
    generate::TinyDataset().write(path("tiny.h5"));
    const files::DatasetReader reader(path("tiny.h5"));
    const PredictorData data(reader);
    const auto predictor = make_image_predictor(data);
    for (const int slot : data.accepted()) {
        const files::SampleRecord sample = reader.read(slot);
        const Positions read = predictor->displacement(data.input(slot, true));
        const double off = (read - sample.displacement).rowwise().norm().maxCoeff();
        EXPECT_GT(off, 0);
        EXPECT_NEAR(off, sample.resampling_error[0], 1e-6);
        EXPECT_NEAR((predicted_cloth(*predictor, sample) - sample.cloth).rowwise().norm().maxCoeff(), off, 1e-5);
    }
}

TEST_F(ImageRoute, NeedsImagesThatThePatternLiesIn) {
    EXPECT_EQ(refusal(written({.samples = 2})), "the data set has no images");
    generate::TinyDataset dataset;
    for (const double place : {-1.0, 47.5, 1e9}) {
        dataset.change_header = [&](files::DatasetHeader& header) { header.image->pattern_pixel(5, 1) = place; };
        dataset.write(path("tiny.h5"));
        EXPECT_EQ(refusal(path("tiny.h5")), "pattern position 5 is not a place in the image");
    }
}

}  // namespace
}  // namespace toile::evaluate

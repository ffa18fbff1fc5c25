#include <gmock/gmock.h>

#include <limits>

#include "cloth/error.h"
#include "evaluate/predictor_data.h"
#include "tests/evaluate/predictor_dataset.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

class Data : public PredictorTest {
  protected:
    std::string refusal(const PredictorDataset& dataset) const {
        try {
            const files::DatasetReader reader(written(dataset));
            const PredictorData data(reader);
            for (const int slot : data.accepted()) {
                data.input(slot, dataset.with_image);
                data.displacement(slot);
                data.embedded(slot);
                data.cloth(slot);
            }
            return "";
        } catch (const Error& error) {
            EXPECT_THAT(error.where(), HasSubstr("dataset.h5"));
            return error.what();
        }
    }
};

TEST_F(Data, HasTheAcceptedSamplesAndWhatTheyHold) {
    PredictorDataset dataset{.samples = 10, .with_image = true};
    dataset.change = [](int slot, files::SampleRecord& sample) { sample.status = slot == 1 || slot == 3 ? 1 : 0; };
    const files::DatasetReader reader(written(dataset));
    const PredictorData data(reader);
    EXPECT_EQ(data.accepted(), (std::vector<int>{0, 2, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(data.train(), (std::vector<int>{0, 2, 5, 6, 7}));
    EXPECT_EQ(data.id(4), 996);
    EXPECT_EQ(data.split(4), 2);
    const files::SampleRecord sample = reader.read(4);
    EXPECT_EQ(data.input(4, true).pose, sample.pose);
    EXPECT_EQ(data.input(4, true).image, sample.image);
    EXPECT_TRUE(data.input(4, false).image.empty());
    EXPECT_EQ(data.displacement(4), sample.displacement);
    EXPECT_EQ(data.cloth(4), sample.cloth);
    EXPECT_EQ(data.embedded(4).position, sample.embedded);
    EXPECT_EQ(data.embedded(4).frame[2].coeffs(), sample.frame[2].coeffs());
}

TEST_F(Data, OneDefectAtATime) {
    PredictorDataset sound{.samples = 5};
    EXPECT_EQ(refusal(sound), "");
    PredictorDataset without_body{.samples = 5, .with_body = false};
    EXPECT_THAT(refusal(without_body), HasSubstr("no embedding"));
    EXPECT_THAT(refusal({.samples = 0}), HasSubstr("empty"));
    PredictorDataset failed = sound;
    failed.change = [](int, files::SampleRecord& sample) { sample.status = 1; };
    EXPECT_THAT(refusal(failed), HasSubstr("none of the data set's 5 samples is accepted"));
}

TEST_F(Data, AStraySplitNamesTheSample) {
    files::Hdf5File file = files::Hdf5File::edit(written({.samples = 5}));
    file.remove("/samples/split");
    file.write("/samples/split", std::vector<std::int8_t>{0, 0, 7, 1, 2}, {5});
    file.set_attribute("/samples/split", "duplicate_angle", 0.1);
    file.close();
    const files::DatasetReader reader(path("dataset.h5"));
    try {
        const PredictorData data(reader);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "sample 998 is in no split there is");
    }
}

TEST_F(Data, NumbersThatAreNotFiniteNameTheSample) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::function<void(files::SampleRecord&)>> damage = {
        [&](files::SampleRecord& sample) { sample.pose(0, 1) = nan; },
        [&](files::SampleRecord& sample) { sample.displacement(1, 1) = nan; },
        [&](files::SampleRecord& sample) { sample.embedded(2, 0) = nan; },
        [&](files::SampleRecord& sample) { sample.cloth(2, 0) = std::numeric_limits<double>::infinity(); },
        [&](files::SampleRecord& sample) { sample.frame[1].x() = nan; },
        [&](files::SampleRecord& sample) { sample.image[3] = static_cast<float>(nan); }};
    for (const auto& one : damage) {
        PredictorDataset dataset{.samples = 5, .with_image = true};
        dataset.change = [&](int slot, files::SampleRecord& sample) {
            if (slot == 3) one(sample);
        };
        EXPECT_THAT(refusal(dataset), HasSubstr("sample 997 is"));
        EXPECT_THAT(refusal(dataset), HasSubstr("not finite"));
        dataset.change = [&](int slot, files::SampleRecord& sample) {
            if (slot != 3) return;
            sample.status = 1;  // nobody looks at what failed
            one(sample);
        };
        EXPECT_EQ(refusal(dataset), "");
    }
}

}  // namespace
}  // namespace toile::evaluate

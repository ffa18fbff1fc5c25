#include "evaluate/predictor_data.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "cloth/error.h"

namespace toile::evaluate {

PredictorData::PredictorData(const files::DatasetReader& dataset) : dataset_(&dataset) {
    const files::Hdf5File& file = dataset.file();
    if (dataset.sample_count() == 0) throw Error("the data set is empty", file.path());
    if (!dataset.header().body || !dataset.header().embedding)
        throw Error("the data set has no embedding, on which displacements are predicted", file.path() + ":/embedding",
                    "predict data sets of cloth on a body");
    const files::Shape one{dataset.sample_count()};
    id_ = file.read<std::int64_t>("/samples/id", one).value;
    split_ = file.read<int>("/samples/split", one).value;
    const std::vector<int> status = file.read<int>("/samples/status", one).value;
    for (int slot = 0; slot < dataset.sample_count(); ++slot) {
        if (status[static_cast<size_t>(slot)] != 0) continue;
        if (split(slot) < 0 || split(slot) > 2)
            throw Error("sample " + std::to_string(id(slot)) + " is in no split there is",
                        file.path() + ":/samples/split");
        accepted_.push_back(slot);
        if (split(slot) == 0) train_.push_back(slot);
    }
    if (accepted_.empty())
        throw Error("none of the data set's " + std::to_string(dataset.sample_count()) + " samples is accepted",
                    file.path() + ":/samples/status", "CARD.md beside it lists the reasons");
}

std::vector<float> PredictorData::values(const char* name, int slot, const files::Shape& row) const {
    files::Shape expected{1};
    expected.insert(expected.end(), row.begin(), row.end());
    files::Array<float> array = dataset_->file().read_rows<float>(name, slot, 1);
    const std::string where = dataset_->file().path() + ":" + name;
    if (array.shape != expected)
        throw Error(std::string(name) + " has samples of shape " +
                        files::shape_text({array.shape.begin() + 1, array.shape.end()}) + ", not " +
                        files::shape_text(row),
                    where);
    if (!std::all_of(array.value.begin(), array.value.end(), [](float one) { return std::isfinite(one); }))
        throw Error("sample " + std::to_string(id(slot)) + " is accepted, but not finite", where,
                    "toile validate says what else is wrong with the data set");
    return std::move(array.value);
}

Positions PredictorData::positions(const char* name, int slot) const {
    const std::vector<float> value = values(name, slot, {vertex_count(), 3});
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(value.data(), vertex_count(), 3)
        .cast<double>();
}

PredictorInput PredictorData::input(int slot, bool with_image) const {
    PredictorInput input;
    input.id = id(slot);
    const files::Array<double> pose = dataset_->file().read_rows<double>("/samples/pose", slot, 1);
    const std::string where = dataset_->file().path() + ":/samples/pose";
    if (pose.shape != files::Shape{1, joint_count(), 3})
        throw Error("/samples/pose has shape " + files::shape_text(pose.shape) + ", not three numbers a joint", where);
    input.pose = Eigen::Map<const Positions>(pose.value.data(), joint_count(), 3);
    if (!input.pose.allFinite())
        throw Error("the pose of sample " + std::to_string(input.id) + " is not finite", where,
                    "toile validate says what else is wrong with the data set");
    if (with_image) {
        const files::DatasetImage& image = dataset_->header().image.value();
        input.image = values("/samples/image", slot, {std::int64_t{3} * image.layers, image.size, image.size});
    }
    return input;
}

Positions PredictorData::displacement(int slot) const {
    return positions("/samples/displacement", slot);
}

Positions PredictorData::cloth(int slot) const {
    return positions("/samples/cloth", slot);
}

pattern::EmbeddedCloth PredictorData::embedded(int slot) const {
    pattern::EmbeddedCloth embedded{positions("/samples/embedded", slot), {}};
    const std::vector<float> frame = values("/samples/frame", slot, {vertex_count(), 4});
    for (size_t i = 0; i < frame.size(); i += 4)
        embedded.frame.emplace_back(frame[i], frame[i + 1], frame[i + 2], frame[i + 3]);
    return embedded;
}

}  // namespace toile::evaluate

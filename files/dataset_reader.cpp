#include <algorithm>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/dataset_header.h"

namespace toile::files {
namespace {

/// One value a sample.
template <typename T>
T value_of(const Hdf5File& file, const std::string& name, int slot) {
    const Array<T> array = file.read_rows<T>(name, slot, 1);
    if (array.shape.size() != 1)
        throw Error(name + " has shape " + shape_text(array.shape) + ", not one value a sample",
                    file.path() + ":" + name);
    return array.value[0];
}

/// One sample's rows of a dataset (N, rows, columns).
template <typename T>
Positions sample_rows(const Hdf5File& file, const std::string& name, int slot, int64_t rows) {
    const Array<T> array = file.read_rows<T>(name, slot, 1);
    if (array.shape != Shape{1, rows, 3})
        throw Error(name + " has samples of shape " + shape_text({array.shape.begin() + 1, array.shape.end()}) +
                        ", not " + shape_text({rows, 3}),
                    file.path() + ":" + name);
    Positions position(rows, 3);
    std::copy(array.value.begin(), array.value.end(), position.data());
    return position;
}

std::vector<Eigen::Quaterniond> sample_frames(const Hdf5File& file, int slot, int64_t vertices) {
    const Array<float> array = file.read_rows<float>("/samples/frame", slot, 1);
    if (array.shape != Shape{1, vertices, 4})
        throw Error("/samples/frame has shape " + shape_text(array.shape), file.path() + ":/samples/frame");
    std::vector<Eigen::Quaterniond> frame;
    for (size_t i = 0; i < array.value.size(); i += 4)
        frame.emplace_back(array.value[i], array.value[i + 1], array.value[i + 2], array.value[i + 3]);
    return frame;
}

/// Data sets written before it was kept for each sample do without.
std::array<double, 2> resampling_error(const Hdf5File& file, int slot) {
    const Array<double> array = file.read_rows<double>("/samples/resampling_error", slot, 1);
    if (array.shape != Shape{1, 2})
        throw Error("/samples/resampling_error does not hold two numbers a sample",
                    file.path() + ":/samples/resampling_error");
    return {array.value[0], array.value[1]};
}

}  // namespace

DatasetReader::DatasetReader(const std::string& path)
    : file_(Hdf5File::open(path)), header_(read_dataset_header(file_)), part_(read_part(file_)) {
    const Shape shape = file_.shape("/samples/id");
    if (shape.size() != 1)
        throw Error("/samples/id has shape " + shape_text(shape) + ", not one value a sample", path + ":/samples/id");
    sample_count_ = static_cast<int>(shape[0]);
}

SampleRecord DatasetReader::read(int slot) const {
    const int64_t vertices = header_.mesh.vertex_count();
    SampleRecord sample;
    sample.id = value_of<int64_t>(file_, "/samples/id", slot);
    sample.split = value_of<int>(file_, "/samples/split", slot);
    sample.status = value_of<int>(file_, "/samples/status", slot);
    sample.cloth = sample_rows<float>(file_, "/samples/cloth", slot, vertices);
    if (header_.body)
        sample.pose =
            sample_rows<double>(file_, "/samples/pose", slot, static_cast<int64_t>(header_.body->joint_name.size()));
    if (header_.embedding) {
        sample.embedded = sample_rows<float>(file_, "/samples/embedded", slot, vertices);
        sample.displacement = sample_rows<float>(file_, "/samples/displacement", slot, vertices);
        sample.frame = sample_frames(file_, slot, vertices);
    }
    if (header_.image) {
        const DatasetImage& image = *header_.image;
        const Array<float> array = file_.read_rows<float>("/samples/image", slot, 1);
        if (array.shape != Shape{1, 3 * image.layers, image.size, image.size})
            throw Error("/samples/image has shape " + shape_text(array.shape) + ", which does not go with /image/mask",
                        file_.path() + ":/samples/image");
        sample.image = array.value;
        if (file_.has("/samples/resampling_error")) sample.resampling_error = resampling_error(file_, slot);
    }
    sample.certificate = read_certificate(file_, slot);
    return sample;
}

Digest DatasetReader::stored_digest(int slot) const {
    const Array<uint8_t> array = file_.read_rows<uint8_t>("/samples/digest", slot, 1);
    Digest digest{};
    if (array.value.size() != digest.size())
        throw Error("/samples/digest has shape " + shape_text(array.shape), file_.path() + ":/samples/digest");
    std::copy(array.value.begin(), array.value.end(), digest.begin());
    return digest;
}

}  // namespace toile::files

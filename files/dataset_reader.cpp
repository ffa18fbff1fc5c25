#include <algorithm>
#include <utility>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/dataset_header.h"

namespace toile::files {
namespace {

/// One value a sample.
template <typename T>
std::vector<T> column_of(const Hdf5File& file, const std::string& name, int first, int count) {
    Array<T> array = file.read_rows<T>(name, first, count);
    if (array.shape.size() != 1)
        throw Error(name + " has shape " + shape_text(array.shape) + ", not one value a sample",
                    file.path() + ":" + name);
    return std::move(array.value);
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

/// `[n x 2]`. Data sets written before it was kept for each sample do without.
std::vector<double> resampling_errors(const Hdf5File& file, int first, int count) {
    const std::string name = "/samples/resampling_error";
    if (!file.has(name)) return std::vector<double>(2 * static_cast<size_t>(count), 0.0);
    const Array<double> array = file.read_rows<double>(name, first, count);
    if (array.shape != Shape{count, 2})
        throw Error(name + " does not hold two numbers a sample", file.path() + ":" + name);
    return array.value;
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
    SampleRecord sample = std::move(read_columns(slot, 1).front());
    read_arrays(slot, sample);
    return sample;
}

std::vector<SampleRecord> DatasetReader::read_columns(int first, int count) const {
    const auto id = column_of<int64_t>(file_, "/samples/id", first, count);
    const auto split = column_of<int>(file_, "/samples/split", first, count);
    const auto status = column_of<int>(file_, "/samples/status", first, count);
    const auto certificate = read_certificates(file_, first, count);
    std::vector<double> error(2 * static_cast<size_t>(count), 0.0);
    if (header_.image) error = resampling_errors(file_, first, count);
    std::vector<SampleRecord> sample(static_cast<size_t>(count));
    for (size_t i = 0; i < sample.size(); ++i) {
        sample[i].id = id[i];
        sample[i].split = split[i];
        sample[i].status = status[i];
        sample[i].certificate = certificate[i];
        sample[i].resampling_error = {error[2 * i], error[2 * i + 1]};
    }
    return sample;
}

void DatasetReader::read_arrays(int slot, SampleRecord& sample) const {
    const int64_t vertices = header_.mesh.vertex_count();
    sample.cloth = sample_rows<float>(file_, "/samples/cloth", slot, vertices);
    if (header_.body)
        sample.pose =
            sample_rows<double>(file_, "/samples/pose", slot, static_cast<int64_t>(header_.body->joint_name.size()));
    if (header_.embedding) {
        sample.embedded = sample_rows<float>(file_, "/samples/embedded", slot, vertices);
        sample.displacement = sample_rows<float>(file_, "/samples/displacement", slot, vertices);
        sample.frame = sample_frames(file_, slot, vertices);
    }
    if (!header_.image) return;
    const DatasetImage& image = *header_.image;
    Array<float> array = file_.read_rows<float>("/samples/image", slot, 1);
    if (array.shape != Shape{1, 3 * image.layers, image.size, image.size})
        throw Error("/samples/image has shape " + shape_text(array.shape) + ", which does not go with /image/mask",
                    file_.path() + ":/samples/image");
    sample.image = std::move(array.value);
}

Digest DatasetReader::stored_digest(int slot) const {
    return stored_digests(slot, 1).front();
}

std::vector<Digest> DatasetReader::stored_digests(int first, int count) const {
    const Array<uint8_t> array = file_.read_rows<uint8_t>("/samples/digest", first, count);
    std::vector<Digest> digest(static_cast<size_t>(count));
    if (array.shape != Shape{count, 16})
        throw Error("/samples/digest has shape " + shape_text(array.shape), file_.path() + ":/samples/digest");
    for (size_t i = 0; i < digest.size(); ++i)
        std::copy_n(array.value.begin() + static_cast<std::ptrdiff_t>(16 * i), 16, digest[i].begin());
    return digest;
}

}  // namespace toile::files
